// A user's node of a dense system, which knows nothing of a simulator: the agent of one robot among
// several, written as patrolling programs are. usage: bench_dense_agent ROBOT INDEX
#include <actionlib/client/simple_action_client.h>
#include <geometry_msgs/PointStamped.h>
#include <move_base_msgs/MoveBaseAction.h>
#include <ros/ros.h>
#include <tf2_ros/transform_listener.h>

#include <atomic>
#include <cstdlib>
#include <string>

namespace {

using Client = actionlib::SimpleActionClient<move_base_msgs::MoveBaseAction>;

constexpr double kLoopHz = 30.0;
constexpr double kSpacing = 2.0;  // m, between the robots' lanes

class Agent {
 public:
  Agent(std::string robot, int index)
      : robot_(std::move(robot)),
        index_(index),
        random_(static_cast<std::uint32_t>(index) + 1U),
        listener_(buffer_),
        client_("/" + robot_ + "/move_base", true),
        positions_(node_.advertise<geometry_msgs::PointStamped>("/positions", 100)),
        heard_(node_.subscribe("/positions", 100, &Agent::onPosition, this)) {}

  void run() {
    client_.waitForServer();
    ros::Rate rate(kLoopHz);
    while (ros::ok()) {
      if (is_idle_.exchange(false)) {
        sendGoal();
      }
      rate.sleep();
    }
  }

 private:
  void sendGoal() {
    move_base_msgs::MoveBaseGoal goal;
    goal.target_pose.header.frame_id = "map";
    goal.target_pose.header.stamp = ros::Time::now();
    goal.target_pose.pose.position.x = nextPlace();
    goal.target_pose.pose.position.y = kSpacing * index_;
    goal.target_pose.pose.orientation.w = 1.0;
    client_.sendGoal(
        goal, [this](const auto&, const auto&) { onEnd(); }, Client::SimpleActiveCallback(),
        [this](const auto&) { sendPosition(); });
  }

  /** Return the next x [m]: to and fro, 5 to 25 m each time. */
  double nextPlace() {
    random_ = random_ * 1664525U + 1013904223U;
    const double length = 5.0 + 20.0 * (random_ >> 8) / static_cast<double>(1U << 24);
    place_ += place_ <= 0.0 ? length : -length;
    return place_;
  }

  void onEnd() {
    sendPosition();
    is_idle_ = true;
  }

  /** Publish the position of this robot, from tf, for the other agents. */
  void sendPosition() {
    geometry_msgs::PointStamped position;
    try {
      const auto pose = buffer_.lookupTransform("map", robot_ + "/base_link", ros::Time(0));
      position.header.stamp = pose.header.stamp;
      position.point.x = pose.transform.translation.x;
      position.point.y = pose.transform.translation.y;
    } catch (const tf2::TransformException&) {
      return;
    }
    position.header.frame_id = robot_;
    positions_.publish(position);
  }

  void onPosition(const geometry_msgs::PointStamped::ConstPtr&) { ++count_; }

  ros::NodeHandle node_;
  std::string robot_;
  int index_;
  std::uint32_t random_;
  double place_ = 0.0;
  std::atomic<bool> is_idle_{true};
  std::atomic<long> count_{0};
  tf2_ros::Buffer buffer_;
  tf2_ros::TransformListener listener_;
  Client client_;
  ros::Publisher positions_;
  ros::Subscriber heard_;
};

}  // namespace

int main(int argc, char** argv) {
  ros::init(argc, argv, "agent");
  if (argc < 3) {
    ROS_FATAL("usage: bench_dense_agent ROBOT INDEX");
    return 2;
  }
  ros::AsyncSpinner spinner(2);
  spinner.start();
  Agent agent(argv[1], std::atoi(argv[2]));
  agent.run();
  ros::waitForShutdown();
  return 0;
}
