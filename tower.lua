defineSimulationParameters{allBodiesAreDynamic=true,gravity={0,0,-9.81},duration=0.4,timestep=0.001,hybrid='exact',integrator='implicit',exactStiffness=1.15e11}
addObject{name='plate',fixed=true,voxelsize=0.0025,position={0,0,-.025},Solid.box{.15,.15,.05}}
addObject{name='box0',density=799.99999999999989,voxelsize=0.0025,position={0,0,0.025},Solid.box{.05,.05,.05}}
addObject{name='box1',density=799999.99999999977,voxelsize=0.0025,position={0,0,0.075},Solid.box{.05,.05,.05}}
addObject{name='box2',density=799999999.99999976,voxelsize=0.0025,position={0,0,0.125},Solid.box{.05,.05,.05}}
