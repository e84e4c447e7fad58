-- "Any one or more of the SPARTA simulation, robot server, VR system tracker, or mobile robot motor power can be shut down
-- and started up again without bringing down any other part" (dissertation section 5.4). One after the other they are,
-- while a person walks to and fro; what each part says of it stands in the run file's events.
local p = params{
  board = parameter("host", "", "of the robot: host, or avr"),
  off = parameter(2, "s", "how long each part is gone"),
}
defineSimulationParameters{ maxStiffness = 300, maxAngularStiffness = 1, duration = 4 + 10 * (p.off + 10) + 3 }
local y, z = 1.0, 0.55
local person = Devices.Hand{ name = "person", loop = true, path = {{position = {0, y, z}, speed = 0.3}, {position = {0.5, y, z}, speed = 0.3}} }
local robot = Robot{ name = "robot", board = p.board, gain = 10000, device = {0, y, 0}, tracker = {name = "ART"} }
local device = Devices.Haption.Virtuose6D3545{ name = "virtuose", base = robot, operator = person, stops = true }
device = TrackedTransform(VRPNRemoteBase(device, 0, z, "Robot@localhost"), "ART")
addDevice(device)

local faults = {
  {"server", function() robot:killServer() end, function() robot:startServer() end},
  {"tracker", function() robot:hideBase(true) end, function() robot:hideBase(false) end},
  {"motor power", function() robot:setPower(false) end, function() robot:setPower(true) end},
  {"serial line", function() robot:unplug(true) end, function() robot:unplug(false) end},
  {"board reset", function() robot:resetBoard() end, function() end},
  {"wheel blocked", function() robot:blockWheel("front left", true) end, function() robot:blockWheel("front left", false) end},
  {"encoder dead", function() robot:breakEncoder("rear right", "dead") end, function() robot:breakEncoder("rear right", "none") end},
  {"encoder reversed", function() robot:breakEncoder("front right", "reversed") end, function() robot:breakEncoder("front right", "none") end},
  {"brown-out", function() robot:setSupply(4) end, function() robot:setSupply(12) end},
  {"axes swapped", function() robot:swapAxes(true) end, function() robot:swapAxes(false); robot:killServer(); robot:startServer() end, 2},
}

local function off_neutral(seconds)
  local most = 0
  for _ = 1, seconds * 60 do
    Actions.waitForRedraw()
    local error = device:recorded("base_error")
    most = math.max(most, math.abs(error[1]), math.abs(error[2]))
  end
  return most
end

Actions.addFrameAction(function()
  local followed = 0
  off_neutral(4)
  for _, fault in ipairs(faults) do
    local name, break_it, mend_it, longer = fault[1], fault[2], fault[3], fault[4] or 0
    break_it()
    measure("off neutral without: " .. name, off_neutral(p.off + longer), "m")
    mend_it()
    off_neutral(6)                                        -- it comes back
    local again = off_neutral(4)
    measure("off neutral after: " .. name, again, "m")
    if again < 0.08 then followed = followed + 1 end
    outcome(followed .. " of " .. #faults .. " came back")
  end
  os.exit()
end)
