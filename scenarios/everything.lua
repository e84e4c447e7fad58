-- The complete pipeline at once: a tracked head, an Omni in a bubble on a mobile robot, a pin that goes into its hole by
-- the hybrid method. Each part can be driven by a recording and switched off:
--   build/verisim trace synth encoder -o drive.csv --path square
--   ./run scenarios/everything.lua --bind robot=drive.csv            the base does what these wheels did
--   ./run scenarios/everything.lua --bind head=HEAD.csv --bind omni=HAND.csv --set operator=false
--   ./run scenarios/everything.lua --set head=false --set robot=false --set bubble=false
local p = params{
  head = parameter(true, "", "a head that a Wii Remote watches"),
  robot = parameter(true, "", "the Omni stands on a mobile robot; else in the room"),
  bubble = parameter(true, "", "the Omni is in a bubble"),
  operator = parameter(true, "", "a modelled person holds the Omni; false: nobody, for --bind omni=TRACE"),
  board = parameter("host", "", "of the robot: host, or avr"),
  hybrid = parameter("restore", "", "off, restore, blend, exact"),
  clearance = parameter(0.005, "m", "between pin and hole, on the radius"),
  voxelsize = parameter(0.0045, "m", "of block and pin"),
  duration = parameter(12, "s", "of the trial"),
}
defineSimulationParameters{ maxStiffness = 300, maxAngularStiffness = 1, hybrid = p.hybrid, duration = p.duration }

-- The world's y is up; the base stands behind the block and its Omni reaches over it.
local height, scale = 0.9, 4                                  -- m, of the Omni on its robot
local y = p.robot and height or 0
local upright = AngleAxis(Degrees(-90), Axis{1, 0, 0})
addObject{ name = "block", fixed = true, density = 10, voxelsize = p.voxelsize, position = {0, 0, 0}, orientation = upright,
  Solid.box{0.375, 0.375, 0.2} - Solid.cylinder{radius = 0.075, height = 0.2} }
local pin = addObject{ name = "pin", density = 10, voxelsize = p.voxelsize, position = {-0.4, 0.35, 0}, orientation = upright,
  Solid.cylinder{radius = 0.075 - p.clearance, height = 0.4} }

-- The hand's own place, in the room; the scale around the chain makes it the pin's.
local above, through = 0.35 / scale, 0.07 / scale
local person = p.operator and Devices.Hand{ name = "person", loop = true, tremor = 0.0002, lead = 0.02, patience = 1.5,
  path = {{position = {-0.1, y + above, 0}, dwell = 0.3}, {position = {0, y + above, 0}, speed = 0.1, dwell = 0.3},
    {position = {0, y + through, 0}, speed = 0.03, dwell = 0.3}, {position = {0, y + above, 0}, speed = 0.03, dwell = 0.3}} } or nil
local robot
local device
if p.robot then
  robot = Robot{ name = "robot", board = p.board, gain = 5000, position = {-0.1, 0, 0}, device = {0, height, 0}, tracker = {name = "ART"} }
  device = Devices.Sensable.PhantomOmni{ name = "omni", scale = 1, base = robot, operator = person }
  device = TrackedTransform(VRPNRemoteBase(device, 0, 0, "Robot@localhost"), "ART")
else
  device = Devices.Sensable.PhantomOmni{ name = "omni", scale = 1, operator = person }
end
if p.robot then device = translateDevice{ device, translation = {0, -y, 0} } end
device = scaleDevice{ device, scale = scale }
if p.bubble then
  device = BubbleTechnique{ device = device, radius = 0.45, stiffness = 50, bubbleVelocityScale = 7, deviceCenter = {0, 0.2, 0} }
end
addDevice(device)
grasp(device, pin)

local head
if p.head then
  head = WiiHead{ name = "head", tracker = "scaat", remote = {motion = "natural", sensor = "wiimote"}, position = {0, 1.2, -1.5} }
end

local inside = false
Actions.addFrameAction(function()
  while true do
    Actions.waitForRedraw()
    if pin.position[2] - 0.2 < -0.1 then inside = true end
    measure("depth", math.max(0, 0.1 - (pin.position[2] - 0.2)), "m")
    if robot then measure("base_moved", (robot.position - Vec(-0.1, height, 0)):length(), "m") end
    if head then measure("head_known", head.valid and 1 or 0, "1") end
    outcome(inside and "inserted" or "on the way")
  end
end)
