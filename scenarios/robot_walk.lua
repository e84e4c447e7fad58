-- A person pulls a pin out of a block, walks across the room with it, pushes it against the fence of a bench and sets it
-- down (dissertation chapter 5, figure 5.5). The haptic device stands on a mobile robot that follows the hand. What is
-- felt of that? The same person does the same beside it with a device that reaches everywhere, and the forces are compared.
--   ./run scenarios/robot_walk.lua --set board=avr      the firmware's machine code, on a simulated ATmega328P
--   ./run scenarios/robot_walk.lua --set twin=false     nobody to compare with
-- The world's y is up. The base stands before the person, who holds the handle 0.55 m behind it (SPARTA's neutral place of
-- the Virtuose). Another seed is another noise of the tracker. Both hands are without tremor, so that their forces can differ
-- by the base alone.
local p = params{
  board = parameter("host", "", "of the robot: host, or avr (needs gcc-avr, avr-libc and simavr)"),
  gain = parameter(10000, "", "of the robot server: mm/s for each m of error"),
  predict = parameter(true, "", "where the base is now, of the tracker's late reports; false: the last report itself"),
  twin = parameter(true, "", "the same person with a device that reaches everywhere"),
  distance = parameter(3, "m", "of the walk"),
  walk = parameter(0.38, "m/s", "between two hasty steps"),
  haste = parameter(1.0, "m/s", "of a hasty step of 0.25 m"),
  push = parameter(0.02, "m", "how far the hand pushes into the fence"),
  delay = parameter(0.02, "s", "of the room's tracker"),
  dropouts = parameter(0, "1/s", "of the tracker, 0.3 s each in the mean"),
  voxelsize = parameter(0.004, "m", "of pin, block and bench"),
}
defineSimulationParameters{ maxStiffness = 300, maxAngularStiffness = 1, frameRate = 1000 }

local y, z, lift = 1.0, 0.55, 0.12                            -- m, of the hand when it begins; and while it walks
local from, to = -p.distance / 2, p.distance / 2
local upright = AngleAxis(Degrees(-90), Axis{1, 0, 0})        -- solids' axes are along z
local hole, radius, height = 0.03, 0.027, 0.12

-- A walk: steps at a steady speed with hasty ones between; then against the fence, back, and down until the pin stands.
local function way(beside)
  local at, hasty, walk, high = from, false, z + beside, y + lift
  local path = {{position = {from, y - 0.03, walk}, dwell = 0.5}, {position = {from, high, walk}, speed = 0.15, dwell = 0.3}}
  while at < to do
    at = math.min(to, at + (hasty and 0.25 or 0.6))
    path[#path + 1] = {position = {at, high, walk}, speed = hasty and p.haste or p.walk}
    hasty = not hasty
  end
  path[#path].dwell = 0.5
  path[#path + 1] = {position = {to + 0.05 + p.push, high, walk}, speed = 0.05, dwell = 1}
  path[#path + 1] = {position = {to, high, walk}, speed = 0.1}
  path[#path + 1] = {position = {to, y - 0.02, walk}, speed = 0.15, dwell = 1}
  return path
end

-- Block, pin, bench with its fence, and a person with a device; `robot` carries it, or nothing does.
local function trial(name, beside, robot)
  local function fixed(what, position, solid)
    addObject{ name = what .. name, fixed = true, density = 10, voxelsize = p.voxelsize, position = position, orientation = upright, solid }
  end
  fixed("block", {from, y - 0.06, z + beside}, Solid.box{0.15, 0.15, 0.06} - Solid.cylinder{radius = hole, height = 0.06})
  fixed("bench", {to, y - 0.10, z + beside}, Solid.box{0.4, 0.4, 0.04})
  fixed("fence", {to + 0.05 + radius + 0.01, y + lift, z + beside}, Solid.box{0.02, 0.4, 0.3})
  local pin = addObject{ name = "pin" .. name, density = 10, voxelsize = p.voxelsize, position = {from, y - 0.03, z + beside},
    orientation = upright, Solid.cylinder{radius = radius, height = height} }
  local device = Devices.Haption.Virtuose6D3545{ name = "virtuose" .. name, base = robot, stops = robot ~= nil,
    operator = Devices.Hand{ path = way(beside) } }
  if robot then device = TrackedTransform(VRPNRemoteBase(device, 0, z, "Robot@localhost"), "ART", true) end
  addDevice(device)
  grasp(device, pin)
  return device, pin
end

local robot = Robot{ name = "robot", board = p.board, gain = p.gain, position = {from, 0, 0}, device = {0, y, 0},
  tracker = {name = "ART", delay = p.delay, dropouts = p.dropouts, predict = p.predict} }
local device, pin = trial("", 0, robot)
local twin
if p.twin then twin = trial("Twin", 2, nil) end

local off, added, free, push, push_twin, pushed = 0, 0, 0, 0, 0, 0
Actions.addFrameAction(function()
  while true do
    Actions.waitForRedraw()
    local error, x = device:recorded("base_error"), pin.position[1]
    off = math.max(off, math.abs(error[1]), math.abs(error[2]))
    measure("handle_off_neutral_max", off, "m")
    measure("heading", robot.heading, "rad")
    local walks = simulation.frame * 0.001 > 2.5 and x < to - 0.1
    local pushes = math.min(device.position[1], (twin or device).position[1]) > to + 0.05 + p.push / 2
    if twin and walks then
      free, added = free + 1, added + (device.forces - twin.forces):length() ^ 2
      measure("added_force_rms", math.sqrt(added / free), "N")
    elseif pushes then
      pushed, push = pushed + 1, push - device.forces[1]
      measure("push_force", push / pushed, "N")
      if twin then
        push_twin = push_twin - twin.forces[1]
        measure("stiffness_felt", push / push_twin, "1")
      end
    end
    outcome(x > to - 0.05 and pin.position[2] < y and "set down" or "on the way")
  end
end)
