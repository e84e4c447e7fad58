-- Boxes fall on a plate and on each other: all bodies move, gravity pulls, no hand. The energy ledger has to close.
local p = params{
  boxes = 4,
  voxelsize = 0.005,        -- m
  gap = 0.02,               -- m, between the boxes at the start
  duration = 2,             -- s
  integrator = "semi-implicit",
}

defineSimulationParameters{
  allBodiesAreDynamic = true, gravity = {0, 0, -9.81}, duration = p.duration, integrator = p.integrator,
}

addObject{name = "plate", fixed = true, voxelsize = p.voxelsize, Solid.box{0.4, 0.4, 0.02}}
local side = 0.06
local boxes = {}
for i = 1, p.boxes do
  boxes[i] = addObject{
    name = "box" .. i, density = 500, voxelsize = p.voxelsize,
    position = {0.002 * (i % 2), 0, 0.01 + (i - 0.5) * side + i * p.gap},
    Solid.box{side, side, side},
  }
end

Actions.addFrameAction(function()
  while true do
    local top = boxes[#boxes]
    measure("top", top.position[3], "m")
    outcome(math.abs(top.position[3] - (0.01 + (#boxes - 0.5) * side)) < side / 2 and "stacked" or "fallen")
    Actions.waitForRedraw()
  end
end)
