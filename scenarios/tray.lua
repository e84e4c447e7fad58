-- Boxes fall into a tray, any way up, and heap up there. All bodies move, gravity pulls, no hand; there is no friction.
-- Measures how much of the kinetic energy is left and whether all boxes stayed in the tray.
local p = params{
  boxes = 100,
  side = 0.03,              -- m
  tray = 0.25,              -- m, inner side; what does not fit into one layer heaps up
  wall = 0.15,              -- m, height of the walls
  apart = 0.053,            -- m, between the boxes' centres at the start: more than their diagonals, so that none overlap
  tilt = 1,                 -- of the largest angle, 3 rad, by which a box is turned at the start
  voxelsize = 0.01,         -- m
  timestep = 0.001,         -- s
  duration = 3,             -- s
  hybrid = "exact",
  restitution = 0,          -- of exact contacts, 0 to 1
  stiffness = 1.15e11,      -- of exact contacts, N/m per metre of an edge
}

defineSimulationParameters{
  allBodiesAreDynamic = true, gravity = {0, 0, -9.81}, duration = p.duration, timestep = p.timestep, hybrid = p.hybrid,
  restitution = p.restitution, exactStiffness = p.stiffness,
}

local thick = 0.02
local outer = p.tray + 2 * thick
addObject{
  name = "tray", fixed = true, voxelsize = p.voxelsize,
  Solid.box{outer, outer, p.wall + thick}:translate{0, 0, (p.wall - thick) / 2}
    - Solid.box{p.tray, p.tray, 2 * p.wall}:translate{0, 0, p.wall},
}
local across = math.max(1, math.floor((p.tray - p.side * 1.75) / p.apart) + 1)
local boxes = {}
for i = 0, p.boxes - 1 do
  local x, y, z = i % across, math.floor(i / across) % across, math.floor(i / across ^ 2)
  local function near(n) return (n - (across - 1) / 2) * p.apart end
  local axis = Axis{math.random() - 0.5, math.random() - 0.5, math.random() - 0.5}
  boxes[i + 1] = addObject{
    name = "box" .. i + 1, density = 1000, voxelsize = p.voxelsize,
    position = {near(x), near(y), p.side + z * p.apart},
    orientation = AngleAxis(p.tilt * 3 * math.random(), axis),
    Solid.box{p.side, p.side, p.side},
  }
end

Actions.addFrameAction(function()
  while true do
    local inside, fastest = 0, 0
    for _, box in ipairs(boxes) do
      local at = box.position
      local half = p.tray / 2
      if math.abs(at[1]) < half and math.abs(at[2]) < half and at[3] > 0 then inside = inside + 1 end
      fastest = math.max(fastest, box.velocity:length())
    end
    measure("inside", inside)
    measure("fastest", fastest, "m/s")
    outcome(inside == #boxes and "all in the tray" or "spilled")
    Actions.waitForRedraw()
  end
end)
