-- Boxes fall on a plate and on each other, each smaller than the one below: all bodies move, gravity pulls, no hand.
-- There is no friction: what keeps the stack is that the pushes of opposite edges cancel.
local p = params{
  boxes = 4,
  voxelsize = 0.005,        -- m
  gap = 0.02,               -- m, between the boxes at the start
  duration = 2,             -- s
  hybrid = "off",
  integrator = "semi-implicit",
}

defineSimulationParameters{
  allBodiesAreDynamic = true, gravity = {0, 0, -9.81}, duration = p.duration, integrator = p.integrator,
  hybrid = p.hybrid,
}

addObject{name = "plate", fixed = true, voxelsize = p.voxelsize, Solid.box{0.4, 0.4, 0.02}}
local height = 0.04
local boxes = {}
for i = 1, p.boxes do
  local side = 0.14 - 0.02 * i
  boxes[i] = addObject{
    name = "box" .. i, density = 500, voxelsize = p.voxelsize,
    position = {0, 0, 0.01 + (i - 0.5) * height + i * p.gap},
    Solid.box{side, side, height},
  }
end

Actions.addFrameAction(function()
  while true do
    local top = boxes[#boxes]
    measure("top", top.position[3], "m")
    outcome(math.abs(top.position[3] - (0.01 + (#boxes - 0.5) * height)) < height / 4 and "stacked" or "fallen")
    Actions.waitForRedraw()
  end
end)
