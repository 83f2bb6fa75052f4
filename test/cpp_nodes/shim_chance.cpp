// An agent as people write them: it is seeded by the time before ROS begins, and has an
// AsyncSpinner, a loop of 30 Hz, random numbers in callbacks and durations by wall clocks. ~what
// chooses other tests.
#include <dirent.h>
#include <dlfcn.h>
#include <fcntl.h>
#include <poll.h>
#include <ros/ros.h>
#include <semaphore.h>
#include <std_msgs/String.h>
#include <sys/random.h>
#include <sys/select.h>
#include <sys/stat.h>
#include <sys/time.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <functional>
#include <future>
#include <iomanip>
#include <memory>
#include <mutex>
#include <random>
#include <shared_mutex>
#include <sstream>
#include <string>
#include <thread>

#include "teller.h"
#include "untold_sources.h"

namespace {

using Clock = std::chrono::steady_clock;

std::unique_ptr<Teller> teller;

template <typename... Values>
void tell(const std::string& what, Values... values) {
  std::ostringstream text;
  text << std::setprecision(17) << what;
  ((text << ' ' << values), ...);
  teller->say(text.str());
}

/** Compute for longer than a millisecond of processor time. */
double compute() {
  double sum = 0;
  for (int k = 0; k < 3000000; ++k) {
    sum += 1.0 / (k + 1 + sum * 1e-9);
  }
  return sum;
}

std::string hex(const void* bytes, std::size_t size) {
  std::ostringstream text;
  for (std::size_t k = 0; k < size; ++k) {
    text << std::hex << static_cast<int>(static_cast<const unsigned char*>(bytes)[k]) << '.';
  }
  return text.str();
}

std::int64_t ns(const timespec& time) { return time.tv_sec * 1000000000LL + time.tv_nsec; }

/** @return the readings of all clocks, as text. */
std::string clocks() {
  std::ostringstream text;
  for (const clockid_t clock :
       {CLOCK_REALTIME, CLOCK_MONOTONIC, CLOCK_MONOTONIC_RAW, CLOCK_BOOTTIME, CLOCK_REALTIME_COARSE,
        CLOCK_PROCESS_CPUTIME_ID, CLOCK_THREAD_CPUTIME_ID}) {
    timespec now{};
    clock_gettime(clock, &now);
    text << ns(now) << ' ';
  }
  timeval now{};
  gettimeofday(&now, nullptr);
  timespec utc{};
  timespec_get(&utc, TIME_UTC);
  text << now.tv_sec << ' ' << now.tv_usec << ' ' << time(nullptr) << ' ' << ns(utc) << ' '
       << clock() << ' ' << std::chrono::system_clock::now().time_since_epoch().count() << ' '
       << Clock::now().time_since_epoch().count() << ' ' << ros::WallTime::now().toNSec() << ' '
       << ros::SteadyTime::now().toNSec();
  return text.str();
}

/** @return values from all sources of chance, as text. */
std::string chance() {
  std::ostringstream text;
  text << rand() << ' ' << random() << ' ' << drand48() << ' ' << lrand48() << ' ' << mrand48();
  unsigned char bytes[12];
  for (const char* path : {"/dev/urandom", "/dev/random"}) {
    const int file = open(path, O_RDONLY);
    text << ' ' << (read(file, bytes, sizeof bytes) == sizeof bytes ? hex(bytes, 12) : "nothing");
    close(file);
  }
  std::ifstream stream("/dev/urandom", std::ios::binary);
  stream.read(reinterpret_cast<char*>(bytes), sizeof bytes);
  text << ' ' << hex(bytes, sizeof bytes);
  text << ' ' << getrandom(bytes, sizeof bytes, 0) << ' ' << hex(bytes, sizeof bytes);
  text << ' ' << getentropy(bytes, sizeof bytes) << ' ' << hex(bytes, sizeof bytes);
#if defined(__GLIBC_PREREQ) && __GLIBC_PREREQ(2, 36)
  arc4random_buf(bytes, sizeof bytes);
  text << ' ' << arc4random() << ' ' << arc4random_uniform(1000) << ' ' << hex(bytes, sizeof bytes);
#endif
  using Name = void(unsigned char*);
  dlopen("libuuid.so.1", RTLD_NOW | RTLD_GLOBAL);
  for (const char* symbol : {"uuid_generate", "uuid_generate_random", "uuid_generate_time"}) {
    auto* const name = reinterpret_cast<Name*>(dlsym(RTLD_DEFAULT, symbol));
    unsigned char uuid[16];
    name(uuid);
    text << ' ' << hex(uuid, sizeof uuid);
  }
  for (const char* token : {"default", "/dev/urandom"}) {
    std::random_device device(token);
    text << ' ' << device();
  }
  return text.str();
}

// These run before main().
const std::string first_clocks = clocks();
const std::string first_chance = chance();

/** A user's agent. */
void agent(std::mt19937& generator, unsigned first) {
  ros::NodeHandle node;
  const auto begin = Clock::now();
  int heard = 0;
  const boost::function<void(const std_msgs::String::ConstPtr&)> callback =
      [&](const std_msgs::String::ConstPtr&) {
        const auto before = Clock::now();
        compute();
        tell("rolls", ++heard, rand() % 1000, (Clock::now() - before).count());
      };
  const auto subscriber = node.subscribe<std_msgs::String>("ticks", 10, callback);
  ros::AsyncSpinner spinner(2);
  spinner.start();
  tell("first", first);
  ros::Rate rate(30);
  for (int k = 0; k < 60 && ros::ok(); ++k) {
    tell("loop", k, rand(), std::uniform_real_distribution<>(0, 1)(generator),
         (Clock::now() - begin).count(), time(nullptr));
    rate.sleep();
  }
}

/** The locks that the other thread of waits() holds; hold() releases them one after the other. */
struct Held {
  sem_t semaphore;
  std::shared_timed_mutex shared;
  std::timed_mutex timed;
  pthread_rwlock_t written = PTHREAD_RWLOCK_INITIALIZER;
  pthread_rwlock_t read = PTHREAD_RWLOCK_INITIALIZER;
  pthread_mutex_t mutex = PTHREAD_MUTEX_INITIALIZER;
  pthread_spinlock_t spin;
  std::promise<int> promise;

  void hold() {
    const std::lock_guard<std::shared_timed_mutex> guard(shared);
    const std::lock_guard<std::timed_mutex> timed_guard(timed);
    pthread_mutex_lock(&mutex);
    pthread_rwlock_wrlock(&written);
    pthread_rwlock_rdlock(&read);
    pthread_spin_lock(&spin);
    const std::function<void()> steps[] = {[] {},
                                           [this] { pthread_spin_unlock(&spin); },
                                           [] {},
                                           [] {},
                                           [this] { pthread_rwlock_unlock(&written); },
                                           [this] { pthread_rwlock_unlock(&read); },
                                           [this] { sem_post(&semaphore); },
                                           [this] { promise.set_value(7); },
                                           [] {}};
    for (const auto& step : steps) {
      ros::Duration(0.25).sleep();
      step();
    }
    pthread_mutex_unlock(&mutex);
  }
};

timespec in(clockid_t clock, double seconds) {
  timespec time{};
  clock_gettime(clock, &time);
  const std::int64_t at = ns(time) + static_cast<std::int64_t>(seconds * 1e9);
  return timespec{at / 1000000000, at % 1000000000};
}

template <typename Result>
void after(const std::string& call, Result result) {
  tell(call, result, ros::Time::now().toNSec());
}

constexpr std::chrono::milliseconds shortly(50);

/** Make a call of libc that waits shortly, by a clock. */
template <typename Call, typename... Given>
void waitBy(const std::string& name, clockid_t clock, Call call, Given... given) {
  const timespec by = in(clock, 0.05);
  after(name, call(given..., &by));
}

/** Waits of libc and the standard library, with time-outs. */
void waitShortly(Held& held) {
  ros::Duration(0.3).sleep();
  pthread_spin_lock(&held.spin);
  pthread_spin_unlock(&held.spin);
  after("spin_lock", 0);
  constexpr auto clock = CLOCK_MONOTONIC;
  waitBy("sem_timedwait", CLOCK_REALTIME, sem_timedwait, &held.semaphore);
  waitBy("sem_clockwait", clock, sem_clockwait, &held.semaphore, clock);
  after("try_lock_for", held.timed.try_lock_for(shortly));
  after("try_lock_shared_for", held.shared.try_lock_shared_for(shortly));
  waitBy("mutex_timedlock", CLOCK_REALTIME, pthread_mutex_timedlock, &held.mutex);
  waitBy("timedrdlock", CLOCK_REALTIME, pthread_rwlock_timedrdlock, &held.written);
  waitBy("timedwrlock", CLOCK_REALTIME, pthread_rwlock_timedwrlock, &held.written);
  waitBy("clockrdlock", clock, pthread_rwlock_clockrdlock, &held.written, clock);
  waitBy("clockwrlock", clock, pthread_rwlock_clockwrlock, &held.written, clock);
}

/** Waits of libc and the standard library, with and without time-outs. */
void waits() {
  Held held;
  sem_init(&held.semaphore, 0, 0);
  pthread_spin_init(&held.spin, PTHREAD_PROCESS_PRIVATE);
  std::thread thread([&held] { held.hold(); });
  waitShortly(held);
  auto future = held.promise.get_future();
  after("wait_for", static_cast<int>(future.wait_for(shortly)));
  after("wait_until",
        static_cast<int>(future.wait_until(std::chrono::system_clock::now() + shortly)));
  after("rdlock", pthread_rwlock_rdlock(&held.written));
  after("wrlock", pthread_rwlock_wrlock(&held.read));
  after("sem_wait", sem_wait(&held.semaphore));
  after("future", future.get());
  waitBy("timedjoin", CLOCK_REALTIME, pthread_timedjoin_np, thread.native_handle(), nullptr);
  thread.join();
  after("join", 0);
}

/** Sleeps without descriptors, and loops that only read a clock. */
void looks() {
  const auto begin = Clock::now();
  poll(nullptr, 0, 20);
  timeval twenty{0, 20000};
  select(0, nullptr, nullptr, nullptr, &twenty);
  ros::WallRate rate(50);
  rate.sleep();
  usleep(5000);
  sleep(0);
  std::this_thread::sleep_until(begin + std::chrono::milliseconds(100));
  timespec by = in(CLOCK_MONOTONIC, 0.01);
  clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &by, nullptr);
  tell("slept", (Clock::now() - begin).count(), ros::Time::now().toNSec());
  while (Clock::now() - begin < std::chrono::milliseconds(113)) {
  }
  const std::clock_t processor = std::clock();
  while (std::clock() - processor < CLOCKS_PER_SEC / 500) {
  }
  tell("looked", (Clock::now() - begin).count(), ros::Time::now().toNSec());
}

/** Use a file that another node uses, too. */
void file(const std::string& path, const std::string& how) {
  if (how == "reads") {
    tell("reads", std::ifstream(path).is_open());
  } else if (how == "renames") {
    std::ofstream(path + ".new") << "1\n";
    tell("renames", std::rename((path + ".new").c_str(), path.c_str()));
  } else if (how == "claims") {
    const std::string claimed = path + "." + ros::this_node::getName().substr(1);
    tell("claims", std::rename(path.c_str(), claimed.c_str()));
  } else if (how == "writes" || how == "locks") {
    tell("writes", std::fopen(path.c_str(), how == "locks" ? "wx" : "a") != nullptr);
  } else if (how == "asks") {
    struct stat found;
    tell("asks", std::filesystem::exists(path), stat(path.c_str(), &found),
         access(path.c_str(), F_OK));
  } else if (how == "removes") {
    tell("removes", std::remove(path.c_str()));
  }
}

/** Tell the order of names in a folder, and when a file in it was written. */
void folder(const std::string& path) {
  std::ofstream(path + "/made") << "1\n";
  ros::Duration(0.25).sleep();
  std::string names;
  for (const auto& one : std::filesystem::directory_iterator(path)) {
    names += ' ' + one.path().filename().string();
  }
  DIR* const opened = opendir(path.c_str());
  readdir(opened);
  const long second = telldir(opened);
  for (int k = 0; k < 2; ++k) {
    names += ' ' + std::string(readdir(opened)->d_name);
    seekdir(opened, second);
  }
  rewinddir(opened);
  tell("lists" + names, readdir(opened)->d_name);
  closedir(opened);
  dirent** scanned = nullptr;
  const int count = scandir(path.c_str(), &scanned, nullptr, nullptr);
  names.clear();
  for (int k = 0; k < count; ++k) {
    names += ' ' + std::string(scanned[k]->d_name);
  }
  tell("scans" + names, count);
  struct stat found;
  stat((path + "/made").c_str(), &found);
  tell("written", ns(found.st_mtim));
}

/** Make one of the calls that lockstep does not follow, or all of them, or ask for files. */
void untold(const std::string& what, ros::NodeHandle& own) {
  if (what == "folder") {
    folder(own.param<std::string>("file", ""));
    return;
  }
  for (const auto& [name, source] : untold_sources::all) {
    if (what == "all" || what == name) {
      tell(name, source());
    }
  }
  file(own.param<std::string>("file", "") + (own.param("odd", false) ? "\xff" : ""),
       own.param<std::string>("how", ""));
}

/** Tell addresses of this program in memory, and what programs get that it starts. */
void addresses() {
  const auto there = std::make_unique<int>(0);
  tell("at", reinterpret_cast<void*>(&compute), static_cast<const void*>(there.get()),
       reinterpret_cast<void*>(&::rand_r));
  tell("hands on", std::getenv("LD_PRELOAD") != nullptr,
       std::getenv("MOVE_BASE_ABSTRACT_LOCKSTEP_CHANCE") != nullptr);
}

sem_t posted;
std::promise<int> promise;

/** The function of a thread that starts before ROS does. */
void stray() {
  while (!teller) {
    usleep(1000);
  }
  rand();
  Clock::now();
  sem_post(&posted);
  usleep(100000);
  promise.set_value(3);
}

}  // namespace

int main(int argc, char** argv) {
  srand(static_cast<unsigned>(time(nullptr)));
  std::mt19937 generator{std::random_device{}()};
  const auto first = static_cast<unsigned>(generator());
  const std::string second = clocks() + ' ' + chance();
  std::thread early;
  if (argc > 1 && std::strcmp(argv[1], "stray") == 0) {
    sem_init(&posted, 0, 0);
    early = std::thread(stray);
  }
  ros::init(argc, argv, "chance");
  ros::NodeHandle node;
  ros::NodeHandle own("~");
  teller = std::make_unique<Teller>("told");
  ros::Duration(0.5).sleep();
  const std::string what = own.param<std::string>("what", "agent");
  tell(first_clocks);
  tell(first_chance);
  tell(second);
  tell(clocks());
  tell(chance());
  if (what == "agent") {
    agent(generator, first);
  } else if (what == "waits") {
    waits();
  } else if (what == "looks") {
    looks();
  } else if (what == "addresses") {
    addresses();
  } else if (what == "stray") {
    tell("posted", sem_wait(&posted));
    tell("promised", promise.get_future().get());
    early.join();
  } else {
    untold(what, own);
  }
  ros::Duration(1.0).sleep();
  own.setParam("done", true);
  return 0;
}
