-- A ball that flies at a plate thinner than a voxel.
local p = params{hybrid = "off", integrator = "semi-implicit", voxelsize = 0.002, v = 1, x = 0.001, y = 0.002, z = 0.03, thick = 0.001}
defineSimulationParameters{hybrid = p.hybrid, integrator = p.integrator, allBodiesAreDynamic = true, duration = 0.1}
addObject{name = "plate", fixed = true, voxelsize = p.voxelsize, Solid.box{0.1, 0.1, p.thick}}
addObject{
  name = "b", density = 2000, voxelsize = p.voxelsize, position = {p.x, p.y, p.z}, velocity = {0, 0, -p.v},
  Solid.sphere{radius = 0.005},
}
