"""The Taylor bar in ParaView: particles as spheres, coloured by plastic strain.

usage: pvpython scripts/taylor_bar_paraview.py taylor_bar.out

Writes taylor_bar.pvsm into the folder, a state that ParaView opens with all dumps (File, Load State; it asks where the
data are), and a picture of the last one. Works for any run with `output vtu`: FIELD and SPACING are all that is of the
Taylor bar.
"""
import os
import sys

from paraview import simple

FIELD, TITLE = "plastic_strain", "plastic strain"
SPACING = 0.38  # mm

if len(sys.argv) != 2:
    sys.exit(__doc__)
folder = os.path.abspath(sys.argv[1])
particles = simple.PVDReader(FileName=os.path.join(folder, "particles.pvd"))
view = simple.GetActiveViewOrCreate("RenderView")
view.ViewSize = [700, 900]
view.Background = [1, 1, 1]
view.UseColorPaletteForBackground = 0
view.OrientationAxesVisibility = 0

times = simple.GetTimeKeeper().TimestepValues
simple.GetAnimationScene().UpdateAnimationUsingDataTimeSteps()
view.ViewTime = times[-1]

spheres = simple.Show(particles, view)
spheres.SetRepresentationType("Point Gaussian")
spheres.GaussianRadius = 0.8*SPACING  # stretched particles leave gaps between spheres of their size
simple.ColorBy(spheres, ("POINTS", FIELD))
spheres.RescaleTransferFunctionToDataRange(False)
colours = simple.GetColorTransferFunction(FIELD)
colours.ApplyPreset("Viridis (matplotlib)", True)
bar = simple.GetScalarBar(colours, view)
bar.Title, bar.ComponentTitle = TITLE, ""
bar.TitleColor = bar.LabelColor = [0, 0, 0]
spheres.SetScalarBarVisibility(view, True)

simple.ResetCamera(view)
view.CameraParallelProjection = 1
view.CameraViewUp = [0, 0, 1]
middle = view.CameraFocalPoint
view.CameraPosition = [middle[0], middle[1] - 100, middle[2] + 25]
simple.ResetCamera(view)
simple.Render(view)

state = os.path.join(folder, "taylor_bar.pvsm")
simple.SaveState(state)
picture = os.path.join(folder, "taylor_bar_paraview.png")
simple.SaveScreenshot(picture, view)
print(state)
print(picture)
