-- How high may the gain be? The dissertation's users raised it until moving a grasped object began to feel wrong (section
-- 5.4). Here the same walk to and fro is made at one gain after the other while the simulation runs; of each the script
-- measures what the hand feels and how far the handle leaves its neutral place.
--   ./run scenarios/robot_gain.lua --set delay=0.05      a slower tracker
local p = params{
  board = parameter("host", "", "of the robot: host, or avr"),
  predict = parameter(true, "", "where the base is now, of the tracker's late reports; false: the last report itself"),
  delay = parameter(0.02, "s", "of the room's tracker"),
  line = parameter(0.001, "s", "delay of the serial line, each way"),
  speed = parameter(0.3, "m/s", "of the walk"),
  each = parameter(8, "s", "at each gain"),
}
local gains = {2500, 5000, 10000, 15000, 20000, 25000, 35000, 50000, 75000, 100000}   -- mm/s for each m of error
defineSimulationParameters{ maxStiffness = 300, maxAngularStiffness = 1, duration = p.each * #gains + 1 }

local y, z = 1.0, 0.55
local box = addObject{ name = "box", density = 200, voxelsize = 0.01, position = {0, y, z}, Solid.box{0.1, 0.1, 0.1} }
local person = Devices.Hand{ name = "person", loop = true, tremor = 0.0003,
  path = {{position = {0, y, z}}, {position = {0.6, y, z}, speed = p.speed}, {position = {0.6, y, z + 0.4}, speed = p.speed},
    {position = {0, y, z}, speed = p.speed}} }
local robot = Robot{ name = "robot", board = p.board, gain = gains[1], device = {0, y, 0}, lineDelay = p.line,
  tracker = {name = "ART", delay = p.delay, predict = p.predict} }
local device = Devices.Haption.Virtuose6D3545{ name = "virtuose", base = robot, operator = person, stops = true }
device = TrackedTransform(VRPNRemoteBase(device, 0, z, "Robot@localhost"), "ART")
addDevice(device)
grasp(device, box)

Actions.addFrameAction(function()
  for _, gain in ipairs(gains) do
    robot:setGain(gain)
    local felt, off, frames, before, jerk = 0, 0, 0, device.forces, 0
    for frame = 1, p.each * 60 do
      Actions.waitForRedraw()
      if frame > 60 then                                  -- a second to settle
        local error, force = device:recorded("base_error"), device.forces
        frames, felt = frames + 1, felt + force:length() ^ 2
        jerk = jerk + (force - before):length() ^ 2
        off = math.max(off, math.abs(error[1]), math.abs(error[2]))
      end
      before = device.forces
    end
    measure(string.format("felt at %d", gain), math.sqrt(felt / frames), "N")
    measure(string.format("change of force in 1/60 s at %d", gain), math.sqrt(jerk / frames), "N")
    measure(string.format("off neutral at %d", gain), off, "m")
  end
  outcome("raised")
end)
