#!MC 1410
# The Taylor bar in Tecplot 360: particles as spheres, coloured by plastic strain.
#
#   sgmp input/taylor_bar.inp --set format=tecplot
#   cd taylor_bar.out
#   tec360 -b -p ../scripts/taylor_bar_tecplot.mcr       (without -b Tecplot stays open)
#
# Reads particles.dat of the folder it is run in; writes taylor_bar.lay, a layout with all dumps for File, Open Layout,
# and a picture of the last one, taylor_bar_tecplot.png. For another run change the list of variables (as in the second
# line of particles.dat), the number of the one that colours, the diameter of the spheres and the time.
$!VarSet |FIELD| = 9
$!VarSet |DIAMETER| = 0.6
$!VarSet |TIME| = 0.08

$!ReadDataSet  '"particles.dat"'
  ReadDataOption = New
  ResetStyle = Yes
  VarLoadMode = ByName
  AssignStrandIDs = No
  InitialPlotType = Cartesian3D
  VarNameList = '"x" "y" "z" "velocity_x" "velocity_y" "velocity_z" "body" "id" "plastic_strain" "stress_xx" "stress_yy" "stress_zz" "stress_xy" "stress_yz" "stress_xz" "pressure"'
# Spheres are as large as a variable says, in the units of the axes: 1.6 times the spacing of the particles, 0.38 mm,
# for stretched particles leave gaps between smaller ones.
$!AlterData 
  Equation = '{diameter} = |DIAMETER|'

$!PlotType = Cartesian3D
$!GlobalTime SolutionTime = |TIME|
$!FieldLayers ShowMesh = No
$!FieldLayers ShowShade = No
$!FieldLayers ShowEdge = No
$!FieldLayers ShowScatter = Yes
$!GlobalScatter Var = |NUMVARS|
$!GlobalScatter RelativeSize = 1
$!GlobalScatter RelativeSizeInGridUnits = Yes
$!FieldMap [1]  Scatter{SymbolShape{GeomShape = Sphere}}
$!FieldMap [1]  Scatter{SizeByVariable = Yes}
$!FieldMap [1]  Scatter{Color = Multi}

$!SetContourVar 
  Var = |FIELD|
  ContourGroup = 1
  LevelInitMode = ResetToNice
$!GlobalContour 1  ColorMapName = 'Sequential - Viridis'
$!GlobalContour 1  ColorMapFilter{ColorMapDistribution = Continuous}
$!GlobalContour 1  Legend{Show = Yes}
$!AttachText 
  AnchorPos
    {
    X = 5
    Y = 94
    }
  Text = 'Taylor bar, t = &(SOLUTIONTIME%.3f) ms'

# From the side, 15 degrees from above; z upwards.
$!ThreeDView 
  PSIAngle = 75
  ThetaAngle = 0
  AlphaAngle = 0
$!View Fit
$!RedrawAll 

$!SaveLayout  "taylor_bar.lay"
  UseRelativePaths = Yes
$!PrintSetup Palette = Color
$!ExportSetup ExportFormat = PNG
$!ExportSetup ImageWidth = 1400
$!ExportSetup UseSuperSampleAntiAliasing = Yes
$!ExportSetup ExportFName = 'taylor_bar_tecplot.png'
$!Export 
  ExportRegion = CurrentFrame
