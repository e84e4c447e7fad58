-- A box that lies on a plate under its weight alone, without friction. The voxels of either may be the finer ones, and
-- both are turned about the vertical.
local p = params{
  hybrid = "restore", integrator = "semi-implicit", duration = 20, x = 0.05, y = 0.04, z = 0.03, plate = 0.15,
  voxelsize = 0.002, plate_voxelsize = 0.002, offset_x = 0.001, offset_y = 0.002, yaw = 0, yaw_box = 0,
}
defineSimulationParameters{
  allBodiesAreDynamic = true, gravity = {0, 0, -9.81}, duration = p.duration, hybrid = p.hybrid,
  integrator = p.integrator,
}
local function turned(solid, angle) return solid:rotate(AngleAxis(angle, Axis{0, 0, 1})) end
addObject{
  name = "plate", fixed = true, voxelsize = p.plate_voxelsize, position = {0, 0, -0.02},
  turned(Solid.box{p.plate, p.plate, 0.04}, p.yaw),
}
addObject{
  name = "box", density = 1000, voxelsize = p.voxelsize, position = {p.offset_x, p.offset_y, p.z / 2},
  turned(Solid.box{p.x, p.y, p.z}, p.yaw_box),
}
