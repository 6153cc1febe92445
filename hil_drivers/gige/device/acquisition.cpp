#include "hil_drivers/gige/device/acquisition.h"

#include <cmath>
#include <memory>

#include <boost/asio/post.hpp>

namespace vbar::gige {

using boost::system::error_code;

struct Acquisition::Frame {
  wire::Leader leader;
  Image image;
};

Acquisition::Acquisition(boost::asio::io_context& context, Registers& registers, StreamSender& sender,
                         const Description& camera, Pace pace, double readout_s, Expose expose)
    : context_(context),
      registers_(registers),
      sender_(sender),
      camera_(camera),
      pace_(pace),
      readout_s_(readout_s),
      expose_(std::move(expose)),
      frame_timer_(context) {}

void Acquisition::start() {
  stop();
  is_acquiring_ = true;
  registers_.lock_for_acquisition(true);
  if (!is_triggered()) run_freely();
}

void Acquisition::stop() {
  run_ = std::make_shared<int>(0);
  is_acquiring_ = false;
  is_exposing_ = false;
  frame_timer_.cancel();
  registers_.lock_for_acquisition(false);
}

bool Acquisition::is_triggered() const {
  return registers_.integer(FeatureId::kTriggerMode) != 0;
}

double Acquisition::frame_period_s() const {
  return 1.0 / registers_.value(FeatureId::kFrameRate);
}

void Acquisition::trigger() {
  ++statistics_.triggers;
  if (!is_acquiring_ || !is_triggered()) return;
  if (ignored_triggers_ > 0) {
    --ignored_triggers_;
    return;
  }
  if (is_exposing_) {
    ++statistics_.triggers_dropped;
    return;
  }
  begin_exposure();
}

void Acquisition::begin_exposure() {
  is_exposing_ = true;
  // Later than the acknowledge of the trigger.
  boost::asio::post(context_, [this, run = std::weak_ptr<int>(run_)] {
    if (!run.expired()) expose();
  });
}

void Acquisition::expose() {
  using enum FeatureId;
  const Clock::time_point begin = Clock::now();
  const auto side = [this](FeatureId id) { return static_cast<int>(registers_.integer(id)); };
  Request request;
  request.region = {side(kOffsetX), side(kOffsetY), side(kWidth), side(kHeight)};
  const double exposure_s = 1e-6 * registers_.value(kExposureTime) * exposure_factor_;
  request.exposure_s = exposure_s;
  request.gain_db = registers_.value(kGain);
  request.black_level_dn = 0.01 * registers_.value(kBlackLevel) * std::ldexp(1.0, camera_.converter_bits);
  request.number = statistics_.exposures++;
  Frame frame;
  frame.leader.payload_type = payload_type_;
  frame.leader.timestamp_ticks =
      static_cast<std::uint64_t>(std::chrono::duration_cast<std::chrono::nanoseconds>(begin - epoch_).count());
  frame.leader.format = static_cast<wire::PixelFormat>(registers_.integer(kPixelFormat));
  frame.leader.width = registers_.integer(kWidth);
  frame.leader.height = registers_.integer(kHeight);
  frame.leader.x = registers_.integer(kOffsetX);
  frame.leader.y = registers_.integer(kOffsetY);
  frame.image = expose_(request);
  frame.image.dn.resize(std::size_t{frame.leader.width} * frame.leader.height);
  // The picture was made within the exposure, not before it.
  const double spent_s = std::chrono::duration<double>(Clock::now() - begin).count();
  after(exposure_s - spent_s,
        [this, shared = std::make_shared<Frame>(std::move(frame))] { end_exposure(std::move(*shared)); });
}

void Acquisition::end_exposure(Frame frame) {
  is_exposing_ = false;
  const double readout_s = readout_s_ * frame.leader.height / camera_.sensor_height;
  after(readout_s, [this, shared = std::make_shared<Frame>(std::move(frame))] { read_out(shared); });
}

void Acquisition::read_out(std::shared_ptr<const Frame> frame) {
  if (lost_frames_ > 0) {
    --lost_frames_;
    ++statistics_.frames_lost;
  } else if (repeated_frames_ > 0 && last_frame_) {
    --repeated_frames_;
    ++statistics_.frames_repeated;
    send(*last_frame_);
  } else {
    send(*frame);
    last_frame_ = std::move(frame);
  }
  if (registers_.integer(FeatureId::kAcquisitionMode) != 0) stop();  // a single frame
}

void Acquisition::send(const Frame& frame) {
  if (!sender_.send(frame.leader, wire::pack_pixels(frame.leader.format, camera_.converter_bits, frame.image.dn)))
    ++statistics_.frames_dropped;
}

void Acquisition::after(double delay_s, std::function<void()> next) {
  auto guarded = [run = std::weak_ptr<int>(run_), call = std::move(next)] {
    if (!run.expired()) call();
  };
  if (pace_ == Pace::kFast || delay_s <= 0.0) return boost::asio::post(context_, std::move(guarded));
  auto timer = std::make_shared<boost::asio::steady_timer>(context_);
  timer->expires_after(std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(delay_s)));
  timer->async_wait([timer, call = std::move(guarded)](const error_code& error) {
    if (!error) call();
  });
}

void Acquisition::run_freely() {
  if (!is_exposing_) begin_exposure();
  frame_timer_.expires_after(
      std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(frame_period_s())));
  frame_timer_.async_wait([this, run = std::weak_ptr<int>(run_)](const error_code& error) {
    if (!error && !run.expired() && !is_triggered()) run_freely();
  });
}

}  // namespace vbar::gige
