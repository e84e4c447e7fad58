-- What sticks? An operator carries a box through a bubble to a wall 3 m away, feels or sees that it touches, and takes it
-- back (dissertation section 4.3.2). While the box touches and the bubble moves on, the handle moves away from the box:
-- so far the hand has to come back before the box comes off.
--   ./run scenarios/bubble_stickiness.lua --set law=cubic --set device=virtuose --seed 7
-- Another seed is another person: arm and tremor are drawn. With task=assemble it carries a peg to a block 3 m away and
-- puts it into its hole.
-- All laws, stiffnesses, devices and cures over 30 operators: build/verisim reproduce (R10).
local p = params{
  law = "peak-ring",    -- "linear", "quadratic", "cubic", "peak-ring", "peak-ring-as-printed"
  velocityScale = 0,    -- of the law; 0: as published, or as fast as the published quadratic law 0.3 m outside
  stiffness = 50,       -- N/m, of the bubble's spring
  radius = 0.45,        -- m
  device = "omni",      -- "omni", "touch", "virtuose", "ideal"
  stop = false,         -- the bubble stops in collision
  bump = 0,             -- N, on the start of a collision; 0: none
  maxStiffness = 300,   -- N/m, of the coupling
  task = "touch",       -- or "assemble"
  distance = 3,         -- m
  surprise = 0,         -- m, how far behind the wall the operator believes it to be; 0: it sees where it is
  stall = 0.5,          -- s: so long a surprised operator sees the box stand still until it turns back
  feels = 0,            -- N: turns back when it feels so much, whatever that is; 0: feeling tells it nothing
  give_up = 60,         -- s
}
defineSimulationParameters{ maxStiffness = p.maxStiffness, maxAngularStiffness = 1, frameRate = 1000, duration = p.give_up }

local scales = {quadratic = 7, ["peak-ring"] = 1.5, ["peak-ring-as-printed"] = 1.5, cubic = 7 / 0.3, linear = 7 * 0.3}
local velocity_scale = p.velocityScale > 0 and p.velocityScale or scales[p.law]
local size, wall = 0.2, p.distance
-- Of the box's centre: a little further than it can come, so that it is there when it touches.
local deeper = math.max(p.surprise, 0.005)
local there = {wall - size / 2 + deeper, 0, 0}

local goals, body
if p.task == "assemble" then
  addObject{ name = "block", fixed = true, voxelsize = 0.02, position = {wall, 0, 0},
    Solid.box{0.5, 0.5, 0.3} - Solid.cylinder{radius = 0.1, height = 0.3} }
  body = addObject{ name = "peg", density = 10, voxelsize = 0.02, position = {0, 0, 0.4}, Solid.cylinder{radius = 0.095, height = 0.4} }
  goals = {{goal = "insert", from = {wall, 0, 0.4}, to = {wall, 0, 0.05}, tolerance = 0.02, giveUp = p.give_up}}
else
  addObject{ name = "wall", fixed = true, voxelsize = 0.02, position = {wall + 0.05, 0, 0}, Solid.box{0.1, 1, 1} }
  body = addObject{ name = "box", density = 10, voxelsize = 0.02, Solid.box{size, size, size} }
  goals = {{goal = "touch and retreat", to = there, retreat = {wall - 1, 0, 0}, tolerance = p.surprise > 0 and 0.01 or 0.0052,
    force = p.feels > 0 and p.feels or 1e9, stall = p.surprise > 0 and p.stall or nil, near = p.surprise > 0 and 2 * p.surprise or nil, giveUp = p.give_up}}
end

local models = {omni = Devices.Sensable.PhantomOmni, touch = Devices.Geomagic.Touch,
  virtuose = Devices.Haption.Virtuose6D3545, ideal = Devices.Ideal}
assert(models[p.device], "device is '" .. p.device .. "'; known: omni, touch, virtuose, ideal")
assert(p.task == "touch" or p.task == "assemble", "task is '" .. p.task .. "'; known: touch, assemble")
local middle = p.device == "virtuose" and {0, 0, 0.55} or {0, 0, 0}
local reach = p.device == "virtuose" and 0.2 or 0.08                   -- m, half of the workspace
local scale = p.device == "virtuose" and 3.2 or 10                     -- the bubble fills the same part of it
local up = p.task == "assemble" and 0.4 or 0
local hand = Devices.Hand{
  goals = goals, watch = "body", start = middle, reach = 1.5 * reach, arm = "drawn",
}
local dev = models[p.device]{ name = p.device, scale = 1, stops = true, operator = hand }
dev = scaleDevice{ translateDevice{ dev, translation = {-middle[1], -middle[2], -middle[3]} }, scale = scale }
dev = BubbleTechnique{
  device = dev, radius = p.radius, stiffness = p.stiffness, law = p.law, bubbleVelocityScale = velocity_scale,
  deviceCenter = {0, 0, 0}, position = {0, 0, up}, stopInCollision = p.stop,
}
if p.bump > 0 then dev = bumpDevice{ dev, force = p.bump } end
addDevice(dev)
grasp(dev, body)

local saturated, frames = 0, 0
local function watch_saturation()
  frames = frames + 1
  saturated = saturated + dev:recorded("saturated")
  measure("saturated", saturated / frames, "1")
  Actions.waitForRedraw()
end

local function carry_to_the_wall()
  outcome("did not come to the wall")
  while body.contacts == 0 do watch_saturation() end
  outcome("stuck")
  measure("time to the wall", simulation.time, "s")
  measure("speed", (p.distance - size / 2) / simulation.time, "m/s")
  -- What the hand feels of the box beside what it feels of the bubble, 20 ms after they met.
  local onset, met = simulation.time, dev:recorded("bubble_center")[1]
  local furthest, since = -math.huge, onset
  local function follow()
    local x = dev.raw.position[1]
    if x > furthest then furthest, since = x, simulation.time end
    return x
  end
  while simulation.time < onset + 0.02 do
    follow()
    watch_saturation()
  end
  local center = dev:recorded("bubble_center")
  local outside = math.max(0, (dev.position - osg.Vec3d(center[1], center[2], center[3])):length() - p.radius)
  local collision, bubble = body.force:length(), p.stiffness * outside
  measure("collision's share of force", collision > 0 and collision / (collision + bubble) or 0, "1")
  -- From where the hand was furthest to where the box comes off for good.
  local back, took, carried = 0, 0, 0
  local free = 0
  while free < 0.2 and simulation.time < p.give_up - 0.01 do
    local x = follow()
    if body.contacts > 0 then
      free = 0
      back, took = furthest - x, simulation.time - since
      carried = dev:recorded("bubble_center")[1] - met
    else
      free = free + simulation.timestep
    end
    watch_saturation()
  end
  measure("way back", back, "m")
  measure("time back", took, "s")
  measure("bubble moved", carried / scale, "m")
  outcome(free >= 0.2 and "released" or "stuck", { stop = true })
end

local function assemble()
  while body.position[3] > 0.1 or math.abs(body.position[1] - wall) > 0.05 do watch_saturation() end
  measure("time to assemble", simulation.time, "s")
  outcome("assembled", { stop = true })
end

outcome("not assembled")
Actions.addFrameAction(p.task == "assemble" and assemble or carry_to_the_wall)
