// Drives robots in Stage's library, without ROS and without a window: stage_drives WORLD STEP_MS ROW_MS < COMMANDS.
//
// A command, in the order of time: MS ROBOT FORWARD LATERAL TURNING; it holds from then on. The last line: MS end.
// A row, each ROW_MS and when a robot begins to stall: @ MS ROBOT pose|stall X Y YAW, and the pose by its odometry.
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <string>

#include <stage.hh>

namespace {

void write(long ms, const std::string& name, const char* kind, const Stg::ModelPosition& robot) {
  const Stg::Pose pose = robot.GetGlobalPose();
  std::printf("@ %ld %s %s %.6f %.6f %.6f %.6f %.6f %.6f\n", ms, name.c_str(), kind, pose.x, pose.y, pose.a,
              robot.est_pose.x, robot.est_pose.y, robot.est_pose.a);
}

}  // namespace

int main(int count, char** words) {
  Stg::Init(&count, &words);
  if (count != 4) return 2;
  const long step_ms = std::atol(words[2]);
  const long row_ms = std::atol(words[3]);
  Stg::World world("drives");
  world.Load(words[1]);
  std::puts("");
  std::map<std::string, Stg::ModelPosition*> robots;
  std::map<std::string, bool> stalls;
  long ms = 0, next_ms = 0;
  char name[64];
  while (std::scanf("%ld %63s", &next_ms, name) == 2) {
    for (; ms < next_ms; ms += step_ms) {
      if (ms % row_ms == 0) {
        for (const auto& [robot, model] : robots) write(ms, robot, "pose", *model);
      }
      world.Update();
      for (const auto& [robot, model] : robots) {
        if (model->Stalled() && !stalls[robot]) write(ms + step_ms, robot, "stall", *model);
        stalls[robot] = model->Stalled();
      }
    }
    if (std::strcmp(name, "end") == 0) break;
    double x = 0.0, y = 0.0, a = 0.0;
    if (std::scanf("%lf %lf %lf", &x, &y, &a) != 3) return 2;
    Stg::ModelPosition*& model = robots[name];
    if (model == nullptr) {
      model = dynamic_cast<Stg::ModelPosition*>(world.GetModel(name));
      if (model == nullptr) return 2;
      model->Subscribe();
    }
    model->SetSpeed(x, y, a);
  }
  for (const auto& [robot, model] : robots) write(ms, robot, "pose", *model);
  std::fflush(stdout);
  std::_Exit(0);  // Stage's world does not survive its own end
}
