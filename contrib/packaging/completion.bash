# SPDX-License-Identifier: LGPL-2.1-or-later
#
# Completion of the arguments of viscoplastic_contact in bash: options,
# parameter files, and after --set the entries that --describe names, with the
# laws of the scene that stands before it.
# shellcheck shell=bash

# The entries as Section/Entry=, one a line; arguments are those of --describe.
_viscoplastic_contact_entries()
{
  "$1" --describe "${@:2}" 2>/dev/null | awk '
    { sub(/^ +/, "") }
    /^subsection / { sub(/^subsection /, ""); path[++depth] = $0; next }
    /^end$/ { --depth; next }
    /^set .* =/ {
      sub(/^set /, ""); sub(/ *=.*/, "")
      prefix = ""
      for (i = 1; i <= depth; ++i) prefix = prefix path[i] "/"
      print prefix $0 "="
    }'
}

_viscoplastic_contact()
{
  local program=${COMP_WORDS[0]} current previous word
  # bash divides words at `=' and `:'; here an entry is one word.
  local line=${COMP_LINE:0:COMP_POINT}
  current=${COMP_WORDS[COMP_CWORD]}
  previous=${COMP_WORDS[COMP_CWORD - 1]}
  COMPREPLY=()

  if [[ $previous == --set || ($previous == = && $line == *--set=*) ]]; then
    local scenes=()
    for word in "${COMP_WORDS[@]:1:COMP_CWORD-1}"; do
      [[ $word == *.prm && -f $word ]] && scenes+=("$word")
    done
    # Within quotes or not, blanks of names are as they are in the file.
    local typed=${current#[\"\']} quote=
    [[ $typed == "$current" ]] || quote=${current:0:1}
    local entry
    while IFS= read -r entry; do
      [[ $entry == "${typed//\\/}"* ]] || continue
      if [[ -n $quote ]]; then
        COMPREPLY+=("$entry")
      else
        COMPREPLY+=("$(printf '%q' "$entry")")
      fi
    done < <(_viscoplastic_contact_entries "$program" "${scenes[@]}")
    compopt -o nospace
    return
  fi
  case $previous in
    --log)
      mapfile -t COMPREPLY < <(compgen -f -- "$current")
      compopt -o filenames
      return
      ;;
  esac
  if [[ $current == -* ]]; then
    # What --help lists, with the values that an option may have.
    local options
    options=$("$program" --help 2>/dev/null | sed -nE '
      s/^  (-h, )?(--[a-z]+)(\[(=[a-z]+)\])?(=[a-z]+)?.*/\2\5 \2\4/p' |
      tr ' ' '\n' | sort -u)
    mapfile -t COMPREPLY < <(compgen -W "$options" -- "$current")
    return
  fi
  mapfile -t COMPREPLY < <(
    compgen -f -X '!*.prm' -- "$current"
    compgen -d -- "$current"
  )
  compopt -o filenames
}

complete -F _viscoplastic_contact viscoplastic_contact
