-- n boxes stand beside each other, 5 mm above a plate, and fall on it.
local p = params{n = 10, hybrid = "exact", integrator = "implicit", voxelsize = 0.004}
defineSimulationParameters{
  hybrid = p.hybrid, integrator = p.integrator, allBodiesAreDynamic = true, gravity = {0, 0, -9.81}, duration = 1,
}
addObject{name = "plate", fixed = true, voxelsize = p.voxelsize, Solid.box{0.5, 1.6, 0.02}:translate{0, 0, -0.01}}
for i = 1, p.n do
  addObject{
    name = "b" .. i, density = 1000, voxelsize = p.voxelsize,
    position = {i % 4 * 0.05 - 0.07, math.floor(i / 4) * 0.05 - 0.07, 0.02}, Solid.box{0.03, 0.03, 0.03},
  }
end
