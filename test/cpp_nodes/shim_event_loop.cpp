// A node with an event loop of Boost.Asio, as drivers and bridges have.
#include <ros/ros.h>
#include <std_msgs/String.h>

#include <boost/asio.hpp>
#include <chrono>
#include <functional>
#include <map>
#include <string>
#include <thread>

#include "teller.h"

namespace shim_event_loop {

namespace {

using boost::asio::deadline_timer;
using boost::asio::steady_timer;

class EventLoop {
 public:
  /** The loop has a thread of its own, and roscpp's callbacks post work to it. */
  void thread() {
    is_ended_by_it_ = true;
    tick(10);
    const auto subscriber =
        node_.subscribe<std_msgs::String>("ticks", 10, [this](const std_msgs::StringConstPtr& m) {
          context_.post([this, text = m->data] { told_.tell("posted " + text); });
        });
    std::thread loop([this] { context_.run(); });
    ros::spin();
    loop.join();
  }

  /** The loop runs in the main thread, and roscpp's callbacks in a spinner. */
  void main() {
    ros::AsyncSpinner spinner(1);
    spinner.start();
    tick(5);
    deadline_timer late(context_, boost::posix_time::milliseconds(730));
    late.async_wait([this](const boost::system::error_code&) { told_.tell("late"); });
    context_.run();
    told_.tell("has run");
    ros::Duration(0.1).sleep();
  }

  /** Another loop polls the event loop in each of its turns. */
  void looks() {
    tick(5);
    for (ros::Rate rate(4); ticks_ > 0; rate.sleep()) {
      context_.poll();
      ros::spinOnce();
    }
  }

  /** Another event loop, whose timer was set before ROS began; time begins at 1 s. */
  void other(boost::asio::io_context& context) {
    context.run();
    told_.tell("other");
    ros::Duration(0.1).sleep();
  }

  /** The loop also has a socket, to which nobody ever sends. */
  void connected() {
    boost::asio::ip::udp::socket socket(
        context_, boost::asio::ip::udp::endpoint(boost::asio::ip::address_v4::loopback(), 0));
    char byte = 0;
    socket.async_receive(boost::asio::buffer(&byte, 1),
                         [](const boost::system::error_code&, std::size_t) {});
    tick(5);
    while (ticks_ > 0) {
      context_.run_one();
    }
  }

 private:
  void tick(int count) {
    ticks_ = count;
    timer_.expires_after(std::chrono::milliseconds(100));
    wait();
  }

  void wait() {
    timer_.async_wait([this](const boost::system::error_code& error) {
      if (error || ticks_ == 0) {
        return;
      }
      told_.tell("tick " + std::to_string(ticks_));
      if (--ticks_ > 0) {
        timer_.expires_at(timer_.expiry() + std::chrono::milliseconds(100));
        wait();
      } else if (is_ended_by_it_) {
        ros::shutdown();
      }
    });
  }

  ros::NodeHandle node_;
  const Teller told_{"/told"};
  boost::asio::io_context context_;
  steady_timer timer_{context_};
  int ticks_ = 0;
  bool is_ended_by_it_ = false;
};

}  // namespace

int nodeMain(int argc, char** argv) {
  boost::asio::io_context early;
  steady_timer timer(early, std::chrono::milliseconds(1400));
  timer.async_wait([](const boost::system::error_code&) {});
  ros::init(argc, argv, "event_loop");
  EventLoop loop;
  const std::string what = ros::NodeHandle("~").param<std::string>("what", "main");
  const std::map<std::string, std::function<void()>> all = {
      {"thread", [&] { loop.thread(); }},       {"main", [&] { loop.main(); }},
      {"looks", [&] { loop.looks(); }},         {"other", [&] { loop.other(early); }},
      {"connected", [&] { loop.connected(); }},
  };
  all.at(what)();
  return 0;
}

}  // namespace shim_event_loop
