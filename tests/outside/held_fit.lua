-- A hand presses a part into what fits it closely, to the side and askew, and holds it there. c: clearance on the radius.
local p = params{kind = "through", c = 1e-5, press = 0.005, side = 0.002, tilt = 0.02, turn = 0, timestep = 0.001, duration = 1.4}
defineSimulationParameters{
  hybrid = "exact", integrator = "implicit", timestep = p.timestep, maxStiffness = 300, duration = p.duration,
}
local r, hollow = 0.01, 0.01 + p.c
local function hole(depth_of_floor)
  return Solid.box{0.06, 0.06, 0.04}:translate{0, 0, -0.01} - Solid.cylinder{radius = hollow, height = 0.1}:translate{0, 0, 0.05 - depth_of_floor}
end
local pin = Solid.cylinder{radius = r, height = 0.04}
local kinds = {  -- the seat, the body, and how high it begins
  post = function() return hole(0.01), pin, 0.0105 end,
  through = function() return hole(0.06), pin, 0 end,
  socket = function()
    return Solid.box{0.06, 0.06, 0.03}:translate{0, 0, -0.015} - Solid.sphere{radius = hollow}, Solid.sphere{radius = r}, 0.0005
  end,
  ring = function()
    return Solid.box{0.08, 0.08, 0.02}:translate{0, 0, -0.01} - Solid.torus{ringRadius = 0.02, radius = 0.006 + p.c},
      Solid.torus{ringRadius = 0.02, radius = 0.006}, 0.0005
  end,
  cap = function()
    return pin, Solid.cylinder{radius = 2 * r, height = 0.03}:translate{0, 0, 0.01}
      - Solid.cylinder{radius = hollow, height = 0.04}:translate{0, 0, -0.005}, 0.0055
  end,
}
local seat, body, z = kinds[p.kind]()
addObject{name = "seat", fixed = true, voxelsize = 0.002, seat}
local b = addObject{name = "body", density = 2000, voxelsize = 0.002, position = {0, 0, z}, body}
local askew = AngleAxis(p.tilt, Axis{math.cos(p.turn), math.sin(p.turn), 0})
local hand = Devices.Hand{
  name = "hand", stiffness = 400, angularStiffness = 5,
  path = {{position = {0, 0, z}, dwell = 0.1}, {position = {p.side, 0, z - p.press}, orientation = askew, speed = 0.05, dwell = 3}},
}
addDevice(hand)
grasp(hand, b)
