// SPDX-License-Identifier: LGPL-2.1-or-later
// What viewer.js uses of vtk.js. The first four only register how to draw.
import "@kitware/vtk.js/Rendering/OpenGL/Actor";
import "@kitware/vtk.js/Rendering/OpenGL/Camera";
import "@kitware/vtk.js/Rendering/OpenGL/PolyDataMapper";
import "@kitware/vtk.js/Rendering/OpenGL/Renderer";

export { default as Actor } from "@kitware/vtk.js/Rendering/Core/Actor";
export { default as DataArray } from "@kitware/vtk.js/Common/Core/DataArray";
export { default as Gestures } from "@kitware/vtk.js/Interaction/Manipulators/GestureCameraManipulator";
export { default as Interactor } from "@kitware/vtk.js/Rendering/Core/RenderWindowInteractor";
export { default as Manipulators } from "@kitware/vtk.js/Interaction/Style/InteractorStyleManipulator";
export { default as Mapper } from "@kitware/vtk.js/Rendering/Core/Mapper";
export { default as OpenGLRenderWindow } from "@kitware/vtk.js/Rendering/OpenGL/RenderWindow";
export { default as Pan } from "@kitware/vtk.js/Interaction/Manipulators/MouseCameraTrackballPanManipulator";
export { default as PolyData } from "@kitware/vtk.js/Common/DataModel/PolyData";
export { default as RenderWindow } from "@kitware/vtk.js/Rendering/Core/RenderWindow";
export { default as Renderer } from "@kitware/vtk.js/Rendering/Core/Renderer";
export { default as Rotate } from "@kitware/vtk.js/Interaction/Manipulators/MouseCameraTrackballRotateManipulator";
export { default as Zoom } from "@kitware/vtk.js/Interaction/Manipulators/MouseCameraTrackballZoomManipulator";
