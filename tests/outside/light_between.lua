-- A light body between a plate and a heavy box that stands, or falls, on it.
local p = params{hybrid = "off", integrator = "semi-implicit", mass = 1e-9, gap = 0, voxelsize = 0.002}
defineSimulationParameters{
  allBodiesAreDynamic = true, gravity = {0, 0, -9.81}, duration = 1, hybrid = p.hybrid, integrator = p.integrator,
}
addObject{name = "plate", fixed = true, voxelsize = p.voxelsize, position = {0, 0, -0.01}, Solid.box{0.2, 0.2, 0.02}}
addObject{name = "light", density = p.mass / 8e-6, voxelsize = p.voxelsize, position = {0, 0, 0.01}, Solid.box{0.02, 0.02, 0.02}}
addObject{name = "heavy", density = 1000, voxelsize = p.voxelsize, position = {0, 0, 0.04 + p.gap}, Solid.box{0.04, 0.04, 0.04}}
