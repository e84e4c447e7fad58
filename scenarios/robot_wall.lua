-- Walls: a person walks on towards the screens; the base stops short of them, at any gain, and the hand feels a limit
-- (dissertation section 5.5, "no specific safeties"). The room is METaL's: 4 x 3 m. Another seed is another walk.
--   ./run scenarios/robot_wall.lua --set gain=100000 --set dropouts=0.5 --seed 7
local p = params{
  gain = parameter(10000, "", "of the robot server: mm/s for each m of error"),
  walls = parameter(true, "", "false: the published system, which has none"),
  board = parameter("host", "", "of the robot: host, or avr"),
  delay = parameter(0.02, "s", "of the room's tracker"),
  dropouts = parameter(0.2, "1/s", "of the tracker, 0.3 s each in the mean"),
  speed = parameter(0.4, "m/s", "of the walk"),
  legs = parameter(12, "", "of the walk"),
  pull = parameter(10, "N", "at most, of the person at the device; 20 N at arm's length turn and drag the base, whatever its motors do"),
}
defineSimulationParameters{ maxStiffness = 300, maxAngularStiffness = 1 }
local y, z, radius = 1.0, 0.55, 0.27                      -- m; radius: of a disc around the base
local half = {2, 1.5}                                     -- m, of the room

local path = {{position = {0, y, z}}}
for _ = 1, p.legs do                                      -- often to places that the base cannot follow to
  path[#path + 1] = {position = {(2 * math.random() - 1) * 1.3 * half[1], y, z + (2 * math.random() - 1) * 1.3 * half[2]},
    speed = p.speed * (0.5 + math.random())}
end
local person = Devices.Hand{ name = "person", path = path, tremor = 0.0003, lead = 0.3, patience = 1, greatestForce = p.pull }
local robot = Robot{ name = "robot", board = p.board, gain = p.gain, device = {0, y, 0},
  tracker = {name = "ART", delay = p.delay, dropouts = p.dropouts},
  walls = p.walls and {min = {-half[1], 0, -half[2]}, max = {half[1], 0, half[2]}, radius = radius} or nil }
local device = Devices.Haption.Virtuose6D3545{ name = "virtuose", base = robot, operator = person, stops = true }
device = TrackedTransform(VRPNRemoteBase(device, 0, z, "Robot@localhost"), "ART")
addDevice(device)

local nearest, felt = 10, 0
Actions.addFrameAction(function()
  while true do
    Actions.waitForRedraw()
    local at = robot.position
    nearest = math.min(nearest, half[1] - math.abs(at[1]) - radius, half[2] - math.abs(at[3]) - radius)
    felt = math.max(felt, device.forces:length())
    measure("room_left", nearest, "m")
    measure("felt_max", felt, "N")
    outcome(nearest > 0 and "stayed clear" or "touched a wall")
  end
end)
