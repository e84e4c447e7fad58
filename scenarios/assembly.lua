-- Any assembly: one of its parts, or several as one, is pulled out along a direction and pushed back; or it is brought
-- to its place from outside by a hand that misjudges where that is. The model shipped: a roller bearing (NU 204) in its
-- housing, and its shaft (20 g6). What of a fit is not known and was left to voxels stands in the summary.
--   verisim run scenarios/assembly.lua --set way=in --set hybrid=exact
--   verisim run scenarios/assembly.lua --set way=in --set hybrid=exact --set instead=models/shaft_m6.step
--   verisim run scenarios/assembly.lua --set way=in --set hybrid=exact --set part=bearing --set without=shaft
--   verisim run scenarios/assembly.lua --set model=bearing.stp --set part=2 --set direction='{1,0,0}'
local p = params{
  model = "models/bearing.step",  -- STEP, BREP or a mesh file, or several with commas between them
  scale = 0,                -- metres per unit of a mesh file; 0: the file's own unit
  part = "shaft",           -- which solids are held: a number, counted from 1 in file order, or a name; `bearing` is
                            -- also `bearing inner ring` and all others whose names begin with that word
  without = "",             -- solids that are left out, likewise
  instead = "",             -- a file whose first solid takes the held one's place
  place = {0, 0, 0},        -- m, where the held solids belong, from where the file has them
  way = "out",              -- "out" and back, or "in"
  direction = {0, 0, 1},    -- of pulling out
  distance = 0,             -- m; 0: the held solids' own size along the direction and a fifth more
  speed = 0.05,             -- m/s
  error = mm(0.5),          -- m, `in`: how far the end that comes first is beside its way, in a direction drawn by seed
  tilt = deg(0.5),          -- rad, `in`: how far the solids are tilted, likewise
  tremor = mm(0.02),        -- m rms, `in`
  voxelsize = 0,            -- m; 0: the assembly's largest side / 100
  hybrid = "restore",
  brep = true,              -- `restore`, `blend`, `exact`: faces of mesh files are recovered from their triangles
  integrator = "implicit",
}
if p.way ~= "in" and p.way ~= "out" then error("way is '" .. p.way .. "'; it is one of in, out") end

-- What is there, and what of it is held.
local options = {brep = p.brep and p.hybrid ~= "off"}
if p.scale > 0 then options.scale = p.scale end
local function is_called(part, i, wanted)
  return i == tonumber(wanted) or part.name == wanted or part.name:sub(1, #wanted + 1) == wanted .. " "
end
local parts, held, count = {}, {}, 0
for file in p.model:gmatch("[^,]+") do
  for i, part in ipairs(modelParts(file, options)) do
    count = count + 1
    local entry = {name = part.name, bounds = part.bounds, file = file, index = i}
    if is_called(part, count, p.part) then
      held[#held + 1] = entry
    elseif p.without == "" or not is_called(part, count, p.without) then
      parts[#parts + 1] = entry
    end
  end
end
if #held == 0 then error(string.format("%s has %d parts, none is '%s'", p.model, count, p.part)) end
if p.instead ~= "" then
  local other = modelParts(p.instead, options)[1]
  held = {{name = other.name, bounds = other.bounds, file = p.instead, index = 1}}
end

local function around(solids)
  local low, high = {math.huge, math.huge, math.huge}, {-math.huge, -math.huge, -math.huge}
  for _, part in ipairs(solids) do
    for axis = 1, 3 do
      low[axis] = math.min(low[axis], part.bounds[1][axis])
      high[axis] = math.max(high[axis], part.bounds[2][axis])
    end
  end
  return osg.Vec3(low[1], low[2], low[3]), osg.Vec3(high[1], high[2], high[3])
end
local low, high = around(held)
local sides = high - low
local voxelsize = p.voxelsize
if voxelsize <= 0 then
  local all = {}
  for _, list in ipairs{parts, held} do for _, part in ipairs(list) do all[#all + 1] = part end end
  local from, to = around(all)
  voxelsize = math.max(to[1] - from[1], to[2] - from[2], to[3] - from[3]) / 100
end

-- The way: from `home` by `distance` along `d`. The hand holds the solids in their middle.
local d = osg.Vec3(p.direction[1], p.direction[2], p.direction[3])
if d:length() == 0 then error("direction is {0, 0, 0}; give one to pull in") end
d = d / d:length()
local reach = math.abs(d[1]) * sides[1] + math.abs(d[2]) * sides[2] + math.abs(d[3]) * sides[3]
local distance = p.distance > 0 and p.distance or 1.2 * reach
local home = osg.Vec3(p.place[1], p.place[2], p.place[3])
local middle = (low + high) * 0.5
local out = d * distance

-- Inwards the hand errs: the middle of the end that comes first is `error` beside the way, all is tilted about it.
local lateral = d ^ (math.abs(d[1]) < 0.9 and osg.Vec3(1, 0, 0) or osg.Vec3(0, 1, 0))
lateral = lateral / lateral:length()
local function across()
  local angle = 2 * math.pi * math.random()
  return lateral * math.cos(angle) + (d ^ lateral) * math.sin(angle)
end
local beside, about = osg.Vec3(0, 0, 0), across()
local tilt = p.way == "in" and p.tilt or 0
local turn = AngleAxis(tilt, Axis{about[1], about[2], about[3]})
if p.way == "in" then
  local arm = d * (0.5 * reach)                       -- from the end to the middle
  beside = across() * p.error + turn * arm - arm
end

defineSimulationParameters{
  hybrid = p.hybrid, integrator = p.integrator,
  maxStiffness = 2000, maxAngularStiffness = 5, maxCouplingForce = 35, maxCouplingTorque = 3,
}
for _, part in ipairs(parts) do
  addObject{name = part.name, density = 7800, voxelsize = voxelsize, fixed = true,
            Model{part.file, part = part.index, scale = options.scale, brep = options.brep}}
end
local start = p.way == "in" and out or osg.Vec3(0, 0, 0)
local object = {
  name = #held == 1 and held[1].name or p.part, density = 7800, voxelsize = voxelsize,
  position = home + middle + start + beside - turn * middle, orientation = turn,
}
for _, part in ipairs(held) do
  object[#object + 1] = Model{part.file, part = part.index, scale = options.scale, brep = options.brep}
end
local body = addObject(object)

local hand = {name = "hand", lead = 0.02, path = {{position = home + middle + start, dwell = 0.1}}}
local function go(to) hand.path[#hand.path + 1] = {position = home + middle + to, speed = p.speed, dwell = 0.3} end
if p.way == "out" then
  go(out)
else
  hand.error, hand.angularError, hand.tremor, hand.angularStiffness = beside, about * tilt, p.tremor, 2
end
go(p.way == "in" and d * -mm(1) or osg.Vec3(0, 0, 0))
local device = Devices.Hand(hand)
addDevice(device)
grasp(device, body)

local farthest = 0
Actions.addFrameAction(function()
  while true do
    local along = (body.position - home) * d
    farthest = math.max(farthest, along)
    measure("pulled", farthest, "m")
    measure("left", along, "m")
    if p.way == "in" then
      outcome(math.abs(along) < 0.02 * distance and "assembled" or "not assembled")
    else
      outcome(farthest < 0.9 * distance and "stuck" or (along < 0.1 * distance and "pulled and returned" or "pulled"))
    end
    Actions.waitForRedraw()
  end
end)
