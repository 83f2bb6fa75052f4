// Calls its callback queues by itself, in several ways, and publishes on /seen what it finds and
// when. ~ways: the ways to use; ~ticks: the number of ticks at 7 Hz.
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <ros/topic.h>
#include <std_msgs/String.h>
#include <std_srvs/Empty.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "teller.h"

namespace shim_reader {

namespace {

using Event = ros::MessageEvent<const std_msgs::String>;

class Reader {
 public:
  Reader() {
    ros::NodeHandle("~").getParam("ways", ways_);
    ros::NodeHandle("~").param("ticks", ticks_, 60);
    other_node_.setCallbackQueue(&other_);
    // Shorter than what comes from tick to tick: the same messages must be dropped in each run.
    heard_.push_back(subscribe(node_, "/quick", 3));
    heard_.push_back(subscribe(node_, "/slow", 100));
    heard_.push_back(subscribe(node_, "/latched", 1));
    service_ = node_.advertiseService("/look", &Reader::look, this);
    if (has("timer")) {
      timer_ = node_.createTimer(ros::Duration(0.05), [this](const ros::TimerEvent& event) {
        seen_.tell("timer " + text(event.current_real));
      });
    }
  }

  int run() {
    std::vector<std::thread> threads;
    if (has("empty")) {
      threads.emplace_back([this] { watchEmpty(); });
    }
    if (has("idle")) {
      threads.emplace_back([this] { waitIdle(); });
    }
    if (has("second")) {
      threads.emplace_back([this] { callOneByOne(); });
    }
    ros::Rate rate(7.0);
    for (int tick = 0; tick < ticks_ && ros::ok(); ++tick) {
      if (has("act")) {
        act(tick);
      }
      look(tick);
      rate.sleep();
    }
    is_over_ = true;
    for (std::thread& thread : threads) {
      thread.join();
    }
    ros::shutdown();
    return 0;
  }

 private:
  bool has(const std::string& way) const {
    return std::find(ways_.begin(), ways_.end(), way) != ways_.end();
  }

  static std::string text(const ros::Time& time) { return std::to_string(time.toNSec()); }

  ros::Subscriber subscribe(ros::NodeHandle& node, const std::string& topic, unsigned size) {
    const boost::function<void(const Event&)> on_event = [this, topic](const Event& event) {
      seen_.tell(topic + " " + event.getMessage()->data + " of " + event.getPublisherName() +
                 " came " + text(event.getReceiptTime()) + " among " +
                 std::to_string(heard_[0].getNumPublishers()));
      if (has("second") && event.getMessage()->data.back() == '7') {
        ros::Duration(0.03).sleep();  // other threads find it in here
      }
    };
    return node.subscribe<std_msgs::String>(topic, size, on_event);
  }

  bool look(std_srvs::Empty::Request&, std_srvs::Empty::Response&) {
    seen_.tell("called");
    return true;
  }

  void look(int tick) {
    if (has("wait") && tick % 20 > 14) {
      ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.021));
    } else if (has("second")) {
      ros::getGlobalCallbackQueue()->callOne();
    } else if (has("usleep")) {
      ros::spinOnce();
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      ros::spinOnce();
    } else {
      ros::spinOnce();
    }
    seen_.tell("looked");
  }

  /** Other calls that programs make between their looks at the queues. */
  void act(int tick) {
    if (tick % 9 == 2) {
      std::vector<std::string> names;
      ros::master::getNodes(names);  // answered when nobody has anything left to do
      seen_.tell("nodes " + std::to_string(names.size()));
    } else if (tick % 9 == 4) {
      heard_[1] = subscribe(node_, "/slow", 2);
    } else if (tick % 9 == 5) {
      heard_[2].shutdown();
      heard_[2] = subscribe(node_, "/latched", 1);
    } else if (tick % 9 == 6) {
      const auto message = ros::topic::waitForMessage<std_msgs::String>("/quick", node_);
      seen_.tell("waited for " + (message ? message->data : "nothing"));
    } else if (tick % 9 == 7) {
      ros::getGlobalCallbackQueue()->disable();
      ros::Duration(0.02).sleep();
      ros::getGlobalCallbackQueue()->enable();
    }
  }

  void watchEmpty() {
    bool was_empty = true;
    while (!is_over_) {
      ros::Duration(0.011).sleep();
      const bool is_empty = ros::getGlobalCallbackQueue()->isEmpty();
      if (is_empty != was_empty) {
        seen_.tell(is_empty ? "empty" : "filled");
      }
      was_empty = is_empty;
    }
  }

  /** A loop that only waits on an empty queue; it goes on when the other threads do. */
  void waitIdle() {
    const int steps = ticks_ / 2;
    while (!is_over_ && looks_ < 4 * steps) {
      other_.callAvailable(ros::WallDuration(0.017));
      ++looks_;
    }
    seen_.tell("the idle loop is over after " + std::to_string(looks_));
  }

  void callOneByOne() {
    while (!is_over_) {
      const auto result = ros::getGlobalCallbackQueue()->callOne();
      seen_.tell("second " + std::to_string(static_cast<int>(result)));
      ros::Duration(0.043).sleep();
    }
  }

  ros::NodeHandle node_;
  ros::NodeHandle other_node_;
  ros::CallbackQueue other_;
  std::vector<std::string> ways_;
  int ticks_ = 0;
  std::atomic<bool> is_over_{false};
  int looks_ = 0;
  const Teller seen_{"/seen"};
  std::vector<ros::Subscriber> heard_;
  ros::ServiceServer service_;
  ros::Timer timer_;
};

/** Publish counts on all topics, at several rates, for 9 s. */
int write() {
  ros::NodeHandle node;
  const ros::Publisher quick = node.advertise<std_msgs::String>("/quick", 100);
  const ros::Publisher slow = node.advertise<std_msgs::String>("/slow", 100);
  const ros::Publisher latched = node.advertise<std_msgs::String>("/latched", 100, true);
  int count = 0;
  const auto tell = [&count](const ros::Publisher& publisher) {
    std_msgs::String message;
    message.data = std::to_string(++count);
    publisher.publish(message);
  };
  const ros::Timer often =
      node.createTimer(ros::Duration(0.02), [&](const ros::TimerEvent&) { tell(quick); });
  const ros::Timer seldom = node.createTimer(ros::Duration(0.07), [&](const ros::TimerEvent&) {
    tell(slow);
    tell(quick);
  });
  const ros::Timer hardly =
      node.createTimer(ros::Duration(0.9), [&](const ros::TimerEvent&) { tell(latched); });
  const ros::Timer end = node.createTimer(
      ros::Duration(9.0), [](const ros::TimerEvent&) { ros::shutdown(); }, true);
  ros::spin();
  return 0;
}

/** Call the service of the reader, which answers only at its next tick. */
int call() {
  ros::NodeHandle node;
  ros::service::waitForService("/look");
  while (ros::ok()) {
    std_srvs::Empty empty;
    ros::service::call("/look", empty);
    ros::Duration(0.31).sleep();
  }
  return 0;
}

}  // namespace

int nodeMain(int argc, char** argv) {
  ros::init(argc, argv, "reader");
  if (argc > 1 && std::string(argv[1]) == "write") {
    return write();
  }
  if (argc > 1 && std::string(argv[1]) == "call") {
    return call();
  }
  return Reader().run();
}

}  // namespace shim_reader
