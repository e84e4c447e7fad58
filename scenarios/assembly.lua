-- Any assembly: one of its parts is held, pulled out along a direction, and pushed back.
--   verisim run scenarios/assembly.lua --set model=bearing.stp --set part=2 --set direction='{1,0,0}'
local p = params{
  model = "assembly.step",  -- STEP, BREP or a mesh file, or several with commas between them
  scale = 0,                -- metres per unit of a mesh file; 0: the file's own unit
  part = "1",               -- which solid is held, counted from 1 in file order, or its name
  direction = {0, 0, 1},    -- of pulling
  distance = 0,             -- m; 0: the held part's own size along the direction and a fifth more
  speed = 0.05,             -- m/s
  voxelsize = 0,            -- m; 0: the assembly's largest side / 100
  hybrid = "off",
  integrator = "semi-implicit",
}

local options = p.scale > 0 and {scale = p.scale} or {}
local parts = {}
for file in p.model:gmatch("[^,]+") do
  for i, part in ipairs(modelParts(file, options)) do
    parts[#parts + 1] = {name = part.name, bounds = part.bounds, file = file, index = i}
  end
end
local held
local low, high = {math.huge, math.huge, math.huge}, {-math.huge, -math.huge, -math.huge}
for i, part in ipairs(parts) do
  if i == tonumber(p.part) or part.name == p.part then held = i end
  for axis = 1, 3 do
    low[axis] = math.min(low[axis], part.bounds[1][axis])
    high[axis] = math.max(high[axis], part.bounds[2][axis])
  end
end
if not held then error(string.format("%s has %d parts, none is '%s'", p.model, #parts, p.part)) end

local largest = math.max(high[1] - low[1], high[2] - low[2], high[3] - low[3])
local voxelsize = p.voxelsize > 0 and p.voxelsize or largest / 100

local length = math.sqrt(p.direction[1] ^ 2 + p.direction[2] ^ 2 + p.direction[3] ^ 2)
local d = {p.direction[1] / length, p.direction[2] / length, p.direction[3] / length}
local reach = 0
for axis = 1, 3 do reach = reach + math.abs(d[axis]) * (parts[held].bounds[2][axis] - parts[held].bounds[1][axis]) end
local distance = p.distance > 0 and p.distance or 1.2 * reach

defineSimulationParameters{maxStiffness = 1000, maxAngularStiffness = 1, hybrid = p.hybrid, integrator = p.integrator}

local body
for i, part in ipairs(parts) do
  local object = addObject{
    name = part.name, density = 7800, voxelsize = voxelsize, fixed = i ~= held,
    Model{part.file, part = part.index, scale = options.scale},
  }
  if i == held then body = object end
end

local home = {0, 0, 0}
local out = {d[1] * distance, d[2] * distance, d[3] * distance}
local hand = Devices.Hand{
  name = "hand", lead = 0.02,
  path = {
    {position = home, dwell = 0.1},
    {position = out, speed = p.speed, dwell = 0.2},
    {position = home, speed = p.speed, dwell = 0.2},
  },
}
addDevice(hand)
grasp(hand, body)

local farthest = 0
Actions.addFrameAction(function()
  while true do
    local x = body.position
    local along = x[1] * d[1] + x[2] * d[2] + x[3] * d[3]
    farthest = math.max(farthest, along)
    measure("pulled", farthest, "m")
    measure("left", along, "m")
    outcome(farthest < 0.9 * distance and "stuck" or (along < 0.1 * distance and "pulled and returned" or "pulled"))
    Actions.waitForRedraw()
  end
end)
