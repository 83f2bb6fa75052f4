// The event-driven clock as a mode of the time master: /clock, state, event log, bystanders.
#pragma once

#include <ros/publisher.h>

#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "clock/achieved_factor.h"
#include "clock_publisher.h"
#include "event_log_writer.h"
#include "lockstep_server.h"
#include "message_bytes.h"
#include "onlooker_wait.h"
#include "parameter_keeper.h"
#include "parameters/parameters.h"
#include "radio_publisher.h"
#include "ros_master_watch.h"
#include "time_mode.h"

namespace move_base_abstract {

/**
 * @brief The mode in which time goes on when all participants have finished the present instant;
 * see LockstepSession.
 */
class LockstepMode : public TimeMode {
 public:
  /**
   * @param begin the first instant [ns, simulated]; 0: the start_time of the settings.
   * @throws std::invalid_argument if a parameter is wrong; the text begins with its key.
   * @throws std::runtime_error if it cannot listen.
   */
  LockstepMode(const NodeParameters& parameters, const ros::Publisher& clock, Nanoseconds begin);
  ~LockstepMode() override;

  const char* name() const override { return "lockstep"; }
  LockstepServer* lockstep() override { return server_.get(); }
  Nanoseconds now() const override { return server_->now(); }
  bool work() override;
  Nanoseconds nextWork() const override;
  std::optional<End> ended() const override { return ended_; }
  bool finish(const std::string& reason) override;
  void describe(TimeState& state) override;
  std::string inUse() const override;
  std::string setFactor(double factor) override;
  std::string pause() override;
  std::string resume() override;
  Nanoseconds step(Nanoseconds duration) override;
  void runUntil(Nanoseconds target) override;
  std::string hold(const std::string& holder, double timeout) override;
  std::string release(const std::string& holder) override;

 private:
  LockstepServer::Listeners listeners();
  void noteStart() const;
  void noteEnd(const LockstepStatus& status) const;
  void finishLog(const LockstepStatus& status, const std::string& reason);
  void logMessages();
  void look(const LockstepStatus& status, Nanoseconds wall);
  void lookForEnd(const LockstepStatus& status);
  void updateBystanders(const LockstepStatus& status);
  std::string notable(const LockstepStatus& status) const;

  const NodeParameters parameters_;
  std::unique_ptr<EventLogWriter> event_log_;
  std::unique_ptr<MessageBytes> message_bytes_;
  std::unique_ptr<ClockPublisher> clock_;
  ParameterKeeper parameters_of_ros_;
  std::unique_ptr<LockstepServer> server_;
  std::unique_ptr<RosMasterWatch> ros_master_;
  RadioPublisher radio_;
  OnlookerWait onlookers_;
  AchievedFactor achieved_;
  std::map<std::string, int> sightings_;  // of nodes that use the clock and do not take part
  int answers_ = 0;                       // of the ROS master, at the latest count of sightings
  std::vector<std::string> bystanders_;
  std::set<std::string> warned_;
  std::string notable_;
  Nanoseconds flush_due_ = 0;  // wall
  bool event_log_failed_ = false;
  bool finished_ = false;
  std::optional<End> ended_;
};

}  // namespace move_base_abstract
