// Programs with threads of their own; ~what chooses one. Each publishes its actions on "told".
#include <netdb.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <std_msgs/String.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/time.h>
#include <unistd.h>

#include <atomic>
#include <boost/thread.hpp>
#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "teller.h"

namespace shim_threads {

namespace {

/** @return a subscriber to "ticks" that tells what it hears. */
ros::Subscriber hear(ros::NodeHandle& node, const Teller& teller) {
  return node.subscribe<std_msgs::String>("ticks", 10,
                                          [&teller](const std_msgs::String::ConstPtr& message) {
                                            teller.tell("heard " + message->data);
                                          });
}

/** Prints the time after each short sleep. */
void naps() {
  while (ros::ok()) {
    usleep(1000);
    std::printf("%.3f\n", ros::Time::now().toSec());
  }
}

/** More threads than have places to sleep in the memory that is shared with the time master. */
void crowd() {
  boost::thread_group threads;
  for (int k = 0; k < 80; ++k) {
    threads.create_thread([] {
      for (int tick = 0; tick < 3000; ++tick) {
        ros::Duration(0.01).sleep();
      }
    });
  }
  threads.join_all();
}

/** A thread for each robot. All threads use one lock, and hold it while they sleep. */
void robots(const Teller& teller) {
  std::mutex mutex;
  std::vector<std::thread> threads;
  for (int robot = 0; robot < 4; ++robot) {
    threads.emplace_back([&, robot] {
      ros::Rate rate(1.0 + robot);
      for (int k = 0; k < 10; ++k) {
        rate.sleep();
        const std::lock_guard<std::mutex> lock(mutex);
        teller.tell("robot " + std::to_string(robot) + " has the lock");
        ros::Duration(0.05).sleep();
        teller.tell("robot " + std::to_string(robot) + " leaves it");
      }
    });
  }
  for (auto& thread : threads) {
    thread.join();
  }
}

/** One thread queues work, and two others take it; waits with time-outs. */
void queue(const Teller& teller) {
  std::mutex mutex;
  std::condition_variable changed;
  std::deque<int> work;
  bool done = false;
  const auto take = [&](const std::string& name) {
    std::unique_lock<std::mutex> lock(mutex);
    while (true) {
      if (!changed.wait_for(lock, std::chrono::milliseconds(300),
                            [&] { return done || !work.empty(); })) {
        teller.tell(name + " has waited in vain");
        continue;
      }
      if (work.empty()) {
        return;
      }
      const int number = work.front();
      work.pop_front();
      lock.unlock();
      teller.tell(name + " takes " + std::to_string(number));
      ros::Duration(0.2).sleep();
      lock.lock();
    }
  };
  std::thread first(take, "first");
  boost::thread second([&] { take("second"); });
  for (int k = 0; k < 12; ++k) {
    ros::Duration(k % 4 == 3 ? 1.0 : 0.1).sleep();
    mutex.lock();
    work.push_back(k);
    mutex.unlock();
    changed.notify_one();
  }
  mutex.lock();
  done = true;
  mutex.unlock();
  changed.notify_all();
  first.join();
  second.join();
}

/** Callbacks that sleep, in the threads of an AsyncSpinner. */
void spinners(const Teller& teller, int threads) {
  ros::NodeHandle node;
  std::vector<ros::Subscriber> subscribers;
  for (const std::string topic : {"ticks", "others"}) {
    const boost::function<void(const std_msgs::String::ConstPtr&)> callback =
        [&teller, topic](const std_msgs::String::ConstPtr& message) {
          teller.tell(topic + " begins " + message->data);
          ros::Duration(0.35).sleep();
          teller.tell(topic + " ends " + message->data);
        };
    subscribers.push_back(node.subscribe<std_msgs::String>(topic, 3, callback));
  }
  ros::AsyncSpinner spinner(static_cast<uint32_t>(threads));
  spinner.start();
  ros::Duration(20).sleep();
  spinner.stop();
}

/** Callbacks without waits, in the threads of an AsyncSpinner. */
void pool(const Teller& teller) {
  ros::NodeHandle node;
  std::thread::id last;
  int changes = 0;
  const auto subscriber =
      node.subscribe<std_msgs::String>("ticks", 3, [&](const std_msgs::String::ConstPtr&) {
        changes += std::this_thread::get_id() == last ? 0 : 1;
        last = std::this_thread::get_id();
        teller.tell("heard in thread " + std::to_string(changes));
      });
  ros::AsyncSpinner spinner(3);
  spinner.start();
  ros::Duration(20).sleep();
  spinner.stop();
}

/** Two AsyncSpinners for one queue, each with one thread; the second ends first. */
void two_spinners(const Teller& teller) {
  ros::NodeHandle node;
  const auto subscriber = hear(node, teller);
  ros::AsyncSpinner first(1);
  first.start();
  ros::AsyncSpinner second(1);
  second.start();
  ros::Duration(0.55).sleep();
  second.stop();
  teller.tell("second has ended");
  ros::Duration(1.0).sleep();
  first.stop();
}

/** A thread calls a queue of its own until a flag is set, while the main thread sleeps. */
void hears(const Teller& teller) {
  ros::CallbackQueue queue;
  ros::NodeHandle node;
  node.setCallbackQueue(&queue);
  std::atomic<bool> is_set{false};
  const auto subscriber = hear(node, teller);
  std::thread looker([&] {
    while (!is_set) {
      queue.callAvailable(ros::WallDuration(0.13));
    }
    teller.tell("ends");
  });
  ros::Duration(30).sleep();
  is_set = true;
  looker.join();
}

/** Sleeps by the wall clock until another thread sets a flag, after 30 s of simulated time. */
void wallLoop(const Teller& teller) {
  std::atomic<bool> is_set{false};
  std::thread setter([&is_set] {
    ros::Duration(30).sleep();
    is_set = true;
  });
  while (!is_set) {
    std::this_thread::sleep_for(std::chrono::milliseconds(250));
  }
  setter.join();
  teller.tell("is set");
}

/** A queue of its own, a connect callback, a timer whose period changes, a MultiThreadedSpinner. */
void queues(const Teller& teller) {
  ros::NodeHandle node;
  const ros::SubscriberStatusCallback connected = [&](const ros::SingleSubscriberPublisher& peer) {
    teller.tell(peer.getSubscriberName() + " listens");
  };
  const ros::Publisher publisher = node.advertise<std_msgs::String>("polled", 10, connected);
  ros::CallbackQueue queue;
  ros::NodeHandle other;
  other.setCallbackQueue(&queue);
  const auto subscriber = hear(other, teller);
  for (int k = 0; k < 12; ++k) {
    queue.callAvailable(ros::WallDuration(0.03));
    teller.tell("round " + std::to_string(k));
  }
  int fired = 0;
  ros::Timer timer;
  const ros::TimerCallback fire = [&](const ros::TimerEvent&) {
    teller.tell("fired");
    timer.setPeriod(ros::Duration(++fired < 3 ? 0.5 : 1.0));
    if (fired == 6) {
      ros::shutdown();
    }
  };
  timer = node.createTimer(ros::Duration(0.25), fire);
  ros::MultiThreadedSpinner spinner(2);
  spinner.spin();
}

/** Timers by the wall clock and the steady clock, whose times the program reads. */
void wall(const Teller& teller) {
  ros::NodeHandle node;
  const ros::WallTime wall_begin = ros::WallTime::now();
  const ros::SteadyTime steady_begin = ros::SteadyTime::now();
  int fired = 0;
  ros::WallTimer wall;
  const ros::WallTimerCallback on_wall = [&](const ros::WallTimerEvent& event) {
    teller.tell("wall " + std::to_string((event.current_real - wall_begin).toNSec()));
    wall.setPeriod(ros::WallDuration(++fired < 3 ? 0.01 : 0.05));
  };
  wall = node.createWallTimer(ros::WallDuration(0.01), on_wall);
  const ros::SteadyTimerCallback on_steady = [&](const ros::SteadyTimerEvent& event) {
    teller.tell("steady " + std::to_string((event.current_real - steady_begin).toNSec()));
  };
  const ros::SteadyTimer steady = node.createSteadyTimer(ros::WallDuration(0.02), on_steady);
  const ros::SteadyTimer once = node.createSteadyTimer(ros::WallDuration(0.1), on_steady, true);
  while (fired < 5) {
    ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.1));
  }
}

/** Threads that only call a queue and read a flag, as those of actionlib's clients do. */
void looks(const Teller& teller) {
  ros::CallbackQueue queue;
  std::atomic<bool> is_set{false};
  const auto look = [&](const std::string& word) {
    while (!is_set) {
      queue.callAvailable(ros::WallDuration(0.1));
    }
    teller.tell(word);
  };
  std::thread first(look, "sees it");
  ros::Rate rate(30);
  for (int k = 0; k < 10; ++k) {
    rate.sleep();
  }
  is_set = true;
  teller.tell("sets it");
  ros::Duration(5).sleep();  // in which nothing else happens
  first.join();
  is_set = false;
  std::thread second(look, "ends");
  ros::Duration(1).sleep();
  is_set = true;
  teller.tell("joins");
  second.join();
  teller.tell("has joined");
}

/** Run @p command in a shell in parallel with this program, whose process is $PPID there. */
void beside(const std::string& command) {
  if (std::system(("(" + command + ") &").c_str()) != 0) {
    throw std::runtime_error(command);
  }
}

/** Ask the ROS master, which answers after a second of wall time. */
void askMaster(ros::NodeHandle& own) {
  const std::string master = std::to_string(own.param("master", 0));
  std::system(("kill -STOP " + master).c_str());
  beside("sleep 1; kill -CONT " + master);
  int answer = 0;
  own.getParam("master", answer);
}

/** Print to a pipe that is read after a second of wall time. */
void print() {
  int ends[2];
  const int output = ::dup(STDOUT_FILENO);
  if (::pipe(ends) == 0) {
    ::dup2(ends[1], STDOUT_FILENO);
    beside("sleep 1; exec cat /proc/$PPID/fd/" + std::to_string(ends[0]) + " >/dev/null");
    std::printf("%s", std::string(200000, '.').c_str());
    std::fflush(stdout);
    ::dup2(output, STDOUT_FILENO);
    ::close(ends[1]);
  }
}

/** Look up a host name; its file of aliases is there after a second of wall time. */
void lookUp(const std::string& aliases) {
  ::mkfifo(aliases.c_str(), 0600);
  ::setenv("HOSTALIASES", aliases.c_str(), 1);
  ::setenv("RES_OPTIONS", "timeout:1 attempts:1", 1);
  beside("sleep 1; timeout 5 sh -c 'while :; do echo >" + aliases + "; done'");
  addrinfo* found = nullptr;
  ::getaddrinfo("nobody", "80", nullptr, &found);
}

/** Make a call that takes wall time, while another thread ticks. */
void stands(const Teller& teller, const std::function<void()>& call) {
  std::thread ticker([&teller] {
    for (int k = 1; k <= 12; ++k) {
      ros::Duration(0.1).sleep();
      teller.tell("tick " + std::to_string(k));
    }
  });
  ros::Duration(0.55).sleep();
  call();
  teller.tell("goes on");
  ticker.join();
}

/** A wait that lockstep does not see. */
void hidden(const Teller& teller) {
  int ends[2];
  char letter = '0';
  bool is_good = ::pipe(ends) == 0;
  std::thread thread([&] {
    ros::Duration(1).sleep();
    teller.tell("writes");
    is_good = ::write(ends[1], "7", 1) == 1 && is_good;
  });
  is_good = ::read(ends[0], &letter, 1) == 1 && is_good;
  teller.tell(is_good ? "got " + std::string(1, letter) : "no pipe");
  thread.join();
  ros::Duration(1).sleep();
  teller.tell("goes on");
}

/** The only thread waits for a connection, which does not come, for 7 s of wall time. */
void outside(const Teller& teller) {
  const int server = ::socket(AF_INET, SOCK_STREAM, 0);
  const timeval most{7, 0};
  const bool is_good = ::setsockopt(server, SOL_SOCKET, SO_RCVTIMEO, &most, sizeof most) == 0 &&
                       ::listen(server, 1) == 0 && ::accept(server, nullptr, nullptr) < 0;
  teller.tell(is_good ? "goes on" : "no connection is waited for");
}

}  // namespace

int nodeMain(int argc, char** argv) {
  ros::init(argc, argv, "threads");
  ros::NodeHandle node;
  ros::NodeHandle own("~");
  const Teller teller("told");
  std::string what;
  own.getParam("what", what);
  const std::map<std::string, std::function<void()>> all = {
      {"robots", [&] { robots(teller); }},
      {"queue", [&] { queue(teller); }},
      {"spinners", [&] { spinners(teller, own.param("threads", 3)); }},
      {"pool", [&] { pool(teller); }},
      {"two_spinners", [&] { two_spinners(teller); }},
      {"hears", [&] { hears(teller); }},
      {"wall_loop", [&] { wallLoop(teller); }},
      {"naps", [] { naps(); }},
      {"crowd", [] { crowd(); }},
      {"queues", [&] { queues(teller); }},
      {"looks", [&] { looks(teller); }},
      {"wall", [&] { wall(teller); }},
      {"master", [&] { stands(teller, [&] { askMaster(own); }); }},
      {"output", [&] { stands(teller, [] { print(); }); }},
      {"names", [&] { stands(teller, [&] { lookUp(own.param<std::string>("aliases", "")); }); }},
      {"hidden", [&] { hidden(teller); }},
      {"outside", [&] { outside(teller); }},
  };
  all.at(what)();
  own.setParam("done", true);
  return 0;
}

}  // namespace shim_threads
