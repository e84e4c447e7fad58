-- A ball that a hand presses 10 mm "into" its seat: two springs in series, the hand's 400 N/m and the coupling's 300 N/m.
-- Seats: a plate, a cone, a tube and a socket that are `clearance` wider than the ball.
local p = params{
  hybrid = "", integrator = "", wall = "flat", voxelsize = 0.002, press = 0.01, clearance = 0.00001, tremor = 0,
}
defineSimulationParameters{
  maxStiffness = 300, hybrid = p.hybrid ~= "" and p.hybrid or nil, integrator = p.integrator ~= "" and p.integrator or nil,
}
local r, c = 0.015, p.clearance
local lying = AngleAxis(math.pi / 2, Axis{0, 1, 0})
local walls = {  -- the solid; where the ball begins, and where it touches
  flat = {function() return Solid.box{0.2, 0.1, 0.02}:translate{0, 0, -0.01} end, {0.0003, 0.0002, 0.025}, r},
  -- the cone's half angle is atan(3 / 4), its tip at z = -0.08 / 3
  cone = {
    function() return Solid.box{0.1, 0.1, 0.04} - Solid.cone{radius1 = 0.005, radius2 = 0.035, height = 0.04} end,
    {0.0003, 0.0002, 0.01}, r * 5 / 3 - 0.08 / 3,
  },
  tube = {
    function() return Solid.box{0.06, 0.06, 0.06} - Solid.cylinder{radius = r + c, height = 0.1}:rotate(lying) end,
    {0.0003, 0, 0}, -c,
  },
  socket = {function() return Solid.box{0.06, 0.06, 0.03}:translate{0, 0, -0.015} - Solid.sphere{radius = r + c} end, {0, 0, 0}, -c},
}
local make, start, touches = unpack(walls[p.wall])
addObject{name = "wall", fixed = true, voxelsize = p.voxelsize, make()}
local tool = addObject{name = "tool", density = 200, voxelsize = p.voxelsize, position = start, Solid.sphere{radius = r}}
local hand = Devices.Hand{
  name = "hand", tremor = p.tremor,
  path = {{position = start, dwell = 0.1}, {position = {start[1], start[2], touches - p.press}, speed = 0.05, dwell = 2}},
}
addDevice(hand)
grasp(hand, tool)
