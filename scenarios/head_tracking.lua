-- Someone draws a block across a plate while a Wii Remote below the screen watches the LEDs on their glasses. The head
-- is tracked beside the loop, 100 times a second; the block moves the same with and without it. The run file says in
-- /state/wii/head what the remote saw, where the head was, and where the tracker believed it to be.
-- Another head: --bind head=TRACE.csv (a wii trace), or another motion or sensor of `verisim wii validate`.
local p = params{
  tracker = "scaat",
  motion = "natural",
  sensor = "wiimote",
  watch = true,             -- false: nobody watches
  duration = 5,             -- s
  voxelsize = 0.004,        -- m
}

defineSimulationParameters{duration = p.duration, maxStiffness = 300}

addObject{name = "plate", fixed = true, voxelsize = p.voxelsize, Solid.box{0.4, 0.2, 0.02}}
local block = addObject{
  name = "block", density = 500, voxelsize = p.voxelsize, position = {-0.1, 0, 0.05},
  Solid.box{0.06, 0.06, 0.04},
}
local hand = Devices.Hand{
  name = "hand", loop = true,
  path = {
    {position = {-0.1, 0, 0.05}},
    {position = {-0.1, 0, 0.028}, speed = 0.1, dwell = 0.2},
    {position = {0.1, 0, 0.028}, speed = 0.1, dwell = 0.2},
    {position = {0.1, 0, 0.05}, speed = 0.1},
  },
}
addDevice(hand)
grasp(hand, block)

if p.watch then
  -- The remote stands 0.4 m behind the plate; its y is up, which is the scene's z.
  local head = WiiHead{
    name = "head", tracker = p.tracker, remote = {motion = p.motion, sensor = p.sensor},
    position = {0, 0.4, 0.1}, orientation = AngleAxis(Degrees(90), Axis{1, 0, 0}),
  }
  local looked, known = 0, 0
  Actions.addFrameAction(function()
    while true do
      looked = looked + 1
      if head.valid then
        known = known + 1
        measure("head_distance", (head.position - Vec(0, 0.4, 0.1)):length(), "m")
      end
      measure("head_known", known / looked, "1")
      outcome(known > 0 and "tracked" or "not seen")
      Actions.waitForRedraw()
    end
  end)
end
