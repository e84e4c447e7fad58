// consumer SCENARIO OUT: runs it, follows a body, and reads what was recorded.
#include <cstdio>
#include <verisim/run.hpp>
#include <verisim/run_file.hpp>

int main(int /*argc*/, char** argv) {
  try {
    double last_x = 0;
    verisim::RunRequest request{.scenario = argv[1], .parameters = {{"duration", "0.2"}}, .seed = 7, .out = argv[2]};
    request.each_frame = [&](const verisim::Frame& frame) {
      last_x = frame.pose("box")[0];
      return frame.number() < 100;
    };
    const verisim::RunOutcome outcome = verisim::run(request);
    const verisim::Run run(argv[2]);
    const verisim::Values pose = run.read("/state/body/box/pose");
    std::printf("%s %llu %s\n", outcome.state_hash.c_str(), static_cast<unsigned long long>(outcome.frames),
                pose.at(run.frames() - 1) == last_x && pose.shape[1] == 7 ? "same" : "other");
  } catch (const verisim::Failure& failure) {
    std::printf("%s\n", failure.what());
    return failure.exit_code();
  }
}
