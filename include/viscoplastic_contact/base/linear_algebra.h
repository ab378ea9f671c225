// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/lac/trilinos_vector.h>

#include <viscoplastic_contact/base/distributed_matrix.h>
#include <viscoplastic_contact/base/types.h>
