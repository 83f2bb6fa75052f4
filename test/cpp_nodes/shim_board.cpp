// A program that writes parameters and reads them, in all ways that roscpp has.
#include <ros/ros.h>

#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

namespace shim_board {

namespace {

std::string of(const ros::NodeHandle& node, const std::string& key, bool is_cached) {
  std::string value = "none";
  if (is_cached) {
    node.getParamCached(key, value);
  } else {
    node.getParam(key, value);
  }
  return value;
}

/** @brief The program sees what it has set in this turn, before other participants do. */
void writeAndRead(ros::NodeHandle& node, int count) {
  const std::string mine = "board " + std::to_string(count);
  node.setParam("/board/latest", mine);
  node.setParam("/board/cpp/small", -1e-12 * count);
  node.setParam("/board/cpp/list", std::vector<int>{count, 2});
  double small = 0.0;
  std::vector<int> list;
  XmlRpc::XmlRpcValue tree;
  const bool is_good = node.getParam("/board/cpp/small", small) && small == -1e-12 * count &&
                       node.getParam("/board/cpp/list", list) && list.at(0) == count &&
                       node.getParam("/board/cpp", tree) && tree.size() == 2 &&
                       of(node, "/board/latest", false) == mine &&
                       of(node, "/board/latest", true) == mine;
  bool is_gone = true;
  if (count % 5 == 0) {
    is_gone = node.deleteParam("/board/cpp") && !node.deleteParam("/board/cpp") &&
              !node.hasParam("/board/cpp/list");
  }
  if (!is_good || !is_gone) {
    std::printf("%d: it does not see what it has set\n", count);
  }
}

/** @brief Check that a program that takes no part sees what was set in this turn. */
void start(ros::NodeHandle& node) {
  node.setParam("/board/errand", 3);
  node.setParam("/board/odd", "\x01");  // text that XML cannot hold is refused, as without lockstep
  node.setParam("/board/nothing", XmlRpc::XmlRpcValue());
  std::string found;
  ros::param::search("/a", "\xff", found);
  std::printf("%d %d\n", node.hasParam("/board/odd"), node.hasParam("/board/nothing"));
  std::fflush(stdout);
  if (std::system("rosparam get /board/errand") != 0) {
    std::printf("there is none\n");
  }
}

/** @brief Set what ask() reads. */
void give(ros::NodeHandle& node) {
  for (int count = 1; count <= 3; ++count) {
    ros::Duration(count == 2 ? 1.5 : 0.25).sleep();
    node.setParam("/board/given", count);
  }
}

/** @brief Log many lines at one instant, and one line at each of many instants. */
void logMuch() {
  const ros::Time before = ros::Time::now();
  for (int line = 1; line <= 2500; ++line) {
    ROS_INFO("line %d", line);
    if (line == 999 || line == 2500) {
      std::printf("%d lines take %.3f s\n", line, (ros::Time::now() - before).toSec());
    }
  }
  int late = 0;
  ros::Rate fast(1000.0);
  for (int line = 1; line <= 1200; ++line) {
    fast.sleep();
    const ros::Time at = ros::Time::now();
    ROS_INFO("line %d", line);
    late += ros::Time::now() != at ? 1 : 0;
  }
  std::printf("%d of 1200 lines of 1200 instants take time\n", late);
}

/** @brief Ask for one parameter again and again, and log. */
void ask(ros::NodeHandle& node) {
  int given = 0;
  while (!node.getParam("/board/given", given)) {
  }
  std::printf("%.3f %d\n", ros::Time::now().toSec(), given);
  logMuch();
  for (int refused = 0; refused < 3; ++refused) {
    std::printf("%d", node.getParam("/board/refused", given) ? 1 : 0);
  }
  std::printf("\n");
  ros::Rate rate(10.0);
  for (int look = 0; look < 6; ++look) {
    rate.sleep();
    for (int again = 0; again < 5; ++again) {
      node.getParam("/board/given", given);
    }
    std::printf("%.3f %d\n", ros::Time::now().toSec(), given);
  }
  std::printf("%d\n", node.hasParam("/board/given/below") || !node.hasParam("/board/given"));
  node.setParam("/board/given", 9);
  node.getParam("/board/given", given);
  std::printf("%d", given);
  rate.sleep();
  node.getParam("/board/given", given);
  std::printf(" %d\n", given);
}

}  // namespace

int nodeMain(int argc, char** argv) {
  ros::init(argc, argv, "board");
  ros::NodeHandle node;
  if (argc > 1 && std::string(argv[1]) == "run_id") {
    for (const char* name : {"/run_id", "/roslaunch", "/board", "/run_id"}) {
      XmlRpc::XmlRpcValue value;
      node.getParam(name, value);
    }
    return 0;
  }
  if (argc > 1) {
    const std::string what = argv[1];
    (what == "ask" ? ask : what == "give" ? give : start)(node);
    return 0;
  }
  ros::Rate rate(10.0);
  for (int count = 1; ros::ok() && count <= 20; ++count) {
    std::string found = "none";
    node.searchParam("board/latest", found);
    std::printf("%.3f %s %s %d:", ros::Time::now().toSec(),
                of(node, "/board/latest", false).c_str(), found.c_str(),
                node.hasParam("/board/a") ? 1 : 0);
    std::vector<std::string> names;
    node.getParamNames(names);
    for (const std::string& name : names) {
      std::printf(name.rfind("/board", 0) == 0 ? " %s" : "", name.c_str());
    }
    std::printf("\n");
    if (of(node, "/board/latest", false) != of(node, "/board/latest", true)) {
      std::printf("what is cached is not what is there\n");
    }
    writeAndRead(node, count);
    rate.sleep();
  }
  return 0;
}

}  // namespace shim_board
