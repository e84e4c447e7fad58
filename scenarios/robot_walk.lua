-- A person pulls a pin out of a block, walks across the room with it and sets it down on a bench (dissertation chapter 5,
-- figure 5.5). The haptic device stands on a mobile robot that follows the hand; nothing is felt of that but the pin.
--   ./run scenarios/robot_walk.lua --set board=avr      the firmware's machine code, on a simulated ATmega328P
--   ./run scenarios/robot_walk.lua --set base=fixed     the same walk with a device that reaches everywhere
-- The world's y is up; the screen is at z = -1.5, the person looks at it. The base stands before the person, who holds the
-- handle 0.55 m behind it (SPARTA's neutral place of the Virtuose).
local p = params{
  base = parameter("robot", "", "what carries the device: robot, or fixed: a device that reaches everywhere"),
  board = parameter("host", "", "of the robot: host, or avr (needs gcc-avr, avr-libc and simavr)"),
  gain = parameter(25000, "", "of the robot server: mm/s for each m of error"),
  predict = parameter(true, "", "where the base is now, of the tracker's late reports; false: the last report itself"),
  distance = parameter(3, "m", "of the walk"),
  walk = parameter(0.38, "m/s", "between two hasty steps"),
  haste = parameter(1.0, "m/s", "of a hasty step of 0.25 m"),
  delay = parameter(0.02, "s", "of the room's tracker"),
  dropouts = parameter(0, "1/s", "of the tracker, 0.3 s each in the mean"),
  voxelsize = parameter(0.004, "m", "of pin, block and bench"),
  duration = parameter(14, "s", "of the trial"),
}
defineSimulationParameters{ maxStiffness = 300, maxAngularStiffness = 1, duration = p.duration }

local y, z = 1.0, 0.55                                        -- m, of the hand when it begins
local from, to = -p.distance / 2, p.distance / 2
local upright = AngleAxis(Degrees(-90), Axis{1, 0, 0})        -- solids' axes are along z
local pin_length, hole = 0.12, 0.03

addObject{ name = "block", fixed = true, density = 10, voxelsize = p.voxelsize, position = {from, y - 0.06, z}, orientation = upright,
  Solid.box{0.15, 0.15, 0.06} - Solid.cylinder{radius = hole, height = 0.06} }
addObject{ name = "bench", fixed = true, voxelsize = p.voxelsize, position = {to, y - 0.10, z}, orientation = upright,
  Solid.box{0.4, 0.4, 0.04} }
local pin = addObject{ name = "pin", density = 10, voxelsize = p.voxelsize, position = {from, y - 0.03, z}, orientation = upright,
  Solid.cylinder{radius = hole - 0.003, height = pin_length} }

-- A walk: steps at a steady speed with hasty ones between, above the bench; then down until the pin stands on it.
local path = {{position = {from, y - 0.03, z}, dwell = 0.5}, {position = {from, y + 0.12, z}, speed = 0.15, dwell = 0.2}}
local at, hasty = from, false
while at < to do
  at = math.min(to, at + (hasty and 0.25 or 0.6))
  path[#path + 1] = {position = {at, y + 0.12, z}, speed = hasty and p.haste or p.walk}
  hasty = not hasty
end
path[#path + 1] = {position = {to, y - 0.02, z}, speed = 0.15, dwell = 1}
local person = Devices.Hand{ name = "person", path = path, tremor = 0.0003 }

local robot, device
if p.base == "robot" then
  robot = Robot{ name = "robot", board = p.board, gain = p.gain, position = {from, 0, 0}, device = {0, y, 0},
    tracker = {name = "ART", delay = p.delay, dropouts = p.dropouts, predict = p.predict} }
  device = Devices.Haption.Virtuose6D3545{ name = "virtuose", base = robot, operator = person, stops = true }
  device = TrackedTransform(VRPNRemoteBase(device, 0, z, "Robot@localhost"), "ART", true)
else
  assert(p.base == "fixed", "base is '" .. tostring(p.base) .. "'; known: robot, fixed")
  device = Devices.Haption.Virtuose6D3545{ name = "virtuose", operator = person }
end
addDevice(device)
grasp(device, pin)

local error_max, felt, frames = 0, 0, 0
Actions.addFrameAction(function()
  while true do
    Actions.waitForRedraw()
    frames = frames + 1
    felt = felt + device.forces:length() ^ 2
    measure("force_rms", math.sqrt(felt / frames), "N")
    if robot then
      local error = device:recorded("base_error")
      error_max = math.max(error_max, math.abs(error[1]), math.abs(error[2]))
      measure("handle_off_neutral_max", error_max, "m")
      measure("heading", robot.heading, "rad")
    end
    local there = math.abs(pin.position[1] - to) < 0.05 and pin.position[2] < y + 0.01
    outcome(there and "set down" or "on the way")
  end
end)
