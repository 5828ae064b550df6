"""VTK's physically-based renderer as a candidate.

    shadeproof doctor --candidate '.venv/bin/python -m reports.outside.vtk_pbr {case} {out}'

VTK draws 8 bits through a gamma of 2.2, so a picture is joined from several exposures. It has one
GGX lobe: a mixture is drawn by its roughness alone. It draws no shadows between surfaces.
"""

import numpy as np

from reports.export.gltf import base_colour
from reports.outside.shared import answer, averaged, joined, unturned
from scenes.mesh import world_mesh
from scenes.schema import Case, Object

GAMMA = 2.2  # in VTK's shader
SCALE = 2  # pixels drawn for each, aside


def draw(case: Case) -> np.ndarray:
    """The case as linear radiance, (h, w, 3) float32."""
    import vtk

    light = unturned(case)
    window = vtk.vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(0)
    window.SetSize(SCALE * case.width, SCALE * case.height)

    def shoot(factor: float) -> np.ndarray:
        renderer = _scene(vtk, case, light * factor)
        window.AddRenderer(renderer)
        window.Render()
        shot = _pixels(vtk, window)
        window.RemoveRenderer(renderer)
        return shot

    picture = joined(shoot, lambda shown: shown**GAMMA)
    return averaged(picture, SCALE).astype(np.float32)


def _scene(vtk, case: Case, light: np.ndarray):
    renderer = vtk.vtkRenderer()
    renderer.SetBackground(0, 0, 0)
    renderer.AutomaticLightCreationOff()
    renderer.UseImageBasedLightingOn()
    renderer.SetEnvironmentTexture(_texture(vtk, light))
    # The map's pole is z; what VTK takes for the right lies towards -y then.
    renderer.SetEnvironmentUp(0, 0, 1)
    renderer.SetEnvironmentRight(0, -1, 0)
    for obj in case.objects:
        renderer.AddActor(_actor(vtk, obj))
    camera = renderer.GetActiveCamera()
    camera.SetPosition(*case.camera.origin)
    camera.SetFocalPoint(*case.camera.target)
    camera.SetViewUp(*case.camera.up)
    camera.SetViewAngle(case.camera.fov)
    renderer.ResetCameraClippingRange()
    return renderer


def _texture(vtk, light: np.ndarray):
    from vtk.util.numpy_support import numpy_to_vtk

    image = vtk.vtkImageData()
    image.SetDimensions(light.shape[1], light.shape[0], 1)
    rows = np.ascontiguousarray(light[::-1], np.float32)  # VTK's row 0 is below
    values = numpy_to_vtk(rows.reshape(-1, 3), deep=True)
    image.GetPointData().SetScalars(values)
    texture = vtk.vtkTexture()
    texture.SetColorModeToDirectScalars()
    texture.MipmapOn()
    texture.InterpolateOn()
    texture.SetInputData(image)
    return texture


def _actor(vtk, obj: Object):
    from vtk.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray

    mesh, material = world_mesh(obj), obj.material
    points = vtk.vtkPoints()
    points.SetData(numpy_to_vtk(np.ascontiguousarray(mesh.vertices, np.float32), deep=True))
    cells = vtk.vtkCellArray()
    faces = np.hstack([np.full((len(mesh.faces), 1), 3), mesh.faces]).astype(np.int64)
    cells.SetCells(len(mesh.faces), numpy_to_vtkIdTypeArray(faces.ravel(), deep=True))
    data = vtk.vtkPolyData()
    data.SetPoints(points)
    data.SetPolys(cells)
    data.GetPointData().SetNormals(numpy_to_vtk(np.ascontiguousarray(mesh.normals), deep=True))
    mapper = vtk.vtkPolyDataMapper()
    mapper.SetInputData(data)
    actor = vtk.vtkActor()
    actor.SetMapper(mapper)
    surface = actor.GetProperty()
    surface.SetInterpolationToPBR()
    surface.SetColor(*base_colour(material))
    surface.SetMetallic(material.metallic)
    surface.SetRoughness(material.roughness)
    if material.f0.eta is not None:
        surface.SetBaseIOR(material.one_eta)
    return actor


def _pixels(vtk, window) -> np.ndarray:
    """What the window shows, (h, w, 3) uint8, row 0 on top."""
    from vtk.util.numpy_support import vtk_to_numpy

    grab = vtk.vtkWindowToImageFilter()
    grab.SetInput(window)
    grab.ReadFrontBufferOff()
    grab.Update()
    image = grab.GetOutput()
    width, height, _ = image.GetDimensions()
    return vtk_to_numpy(image.GetPointData().GetScalars()).reshape(height, width, -1)[::-1, :, :3]


if __name__ == "__main__":
    answer(draw)
