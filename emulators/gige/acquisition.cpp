#include "emulators/gige/acquisition.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include <boost/asio/buffer.hpp>
#include <boost/asio/post.hpp>
#include <netinet/in.h>
#include <sys/socket.h>

namespace vbar::gige {

namespace {

namespace asio = boost::asio;
using boost::system::error_code;
using Clock = std::chrono::steady_clock;

/// Requests that wait; more are a host that asks faster than packets leave.
constexpr std::size_t kMaxResends = 256;
/// Largest delay of packets that a late timer makes up for at once. A camera does not burst; on a busy computer the
/// timer is late by milliseconds, and the packets pending since then have to stay well below what the buffer of the
/// receiver holds.
constexpr std::chrono::microseconds kMaxDebt(3000);
/// Packets between two looks at the commands of the host.
constexpr int kPacketsAtATime = 64;

}  // namespace

StreamSender::StreamSender(asio::io_context& context, const asio::ip::address_v4& address, std::uint64_t seed)
    : socket_(context, asio::ip::udp::endpoint(address, 0)), timer_(context), random_(seed, "gige/packet_faults") {
  socket_.non_blocking(true);
}

void StreamSender::set_silent(bool silent) {
  is_silent_ = silent;
  if (silent) clear();
}

void StreamSender::clear() {
  resends_.clear();
  blocks_.clear();
  kept_.clear();
  delayed_.clear();
}

void StreamSender::close() {
  clear();
  alive_.reset();
  timer_.cancel();
  error_code ignored;
  socket_.close(ignored);
}

bool StreamSender::send(const wire::Leader& leader, wire::Bytes payload) {
  if (is_silent_) return true;
  if (blocks_.size() >= kMaxQueued) return false;
  auto block = std::make_shared<Block>();
  block->number = next_number_;
  next_number_ = next_number_ == 0xFFFF ? std::uint16_t{1} : static_cast<std::uint16_t>(next_number_ + 1);
  block->leader = leader;
  block->payload = std::move(payload);
  block->data_bytes = channel_.packet_size - wire::kPacketOverheadBytes;
  blocks_.push_back({block, block->number, 0, block->last_packet(), false});
  kept_.push_back(std::move(block));
  if (kept_.size() > kKept) kept_.pop_front();
  ++statistics_.blocks;
  pump();
  return true;
}

void StreamSender::resend(const wire::PacketResend& request) {
  ++statistics_.resend_requests;
  if (is_silent_ || resends_.size() >= kMaxResends) return;
  const auto found =
      std::ranges::find_if(kept_, [&request](const auto& block) { return block->number == request.block; });
  if (found == kept_.end()) {
    // One packet states it for all that were asked for.
    resends_.push_back({nullptr, request.block, request.first, request.first, true});
  } else if (request.first <= (*found)->last_packet()) {
    resends_.push_back({*found, request.block, request.first, std::min(request.last, (*found)->last_packet()), true});
  }
  pump();
}

void StreamSender::pump() {
  if (is_pumping_) return;
  for (int count = 0; !resends_.empty() || !blocks_.empty(); ++count) {
    const Clock::time_point now = Clock::now();
    const bool is_early = channel_.packet_delay.count() > 0 && due_ > now;
    if (is_early || count == kPacketsAtATime) {
      is_pumping_ = true;
      timer_.expires_at(is_early ? due_ : now);
      timer_.async_wait([this, alive = std::weak_ptr<int>(alive_)](const error_code& /*error*/) {
        if (alive.expired()) return;
        is_pumping_ = false;
        pump();
      });
      return;
    }
    std::deque<Run>& runs = resends_.empty() ? blocks_ : resends_;
    send_next(runs.front());
    if (runs.front().next > runs.front().last) runs.pop_front();
    due_ = std::max(due_, now - kMaxDebt) + channel_.packet_delay;
  }
  if (!delayed_.empty()) transmit(std::exchange(delayed_, {}));
}

void StreamSender::encode(const Run& run) {
  const wire::Status status = run.again ? wire::Status::kPacketResend : wire::Status::kSuccess;
  if (!run.block) return wire::encode_unavailable(run.number, run.next, datagram_);
  const Block& block = *run.block;
  if (run.next == 0) return wire::encode_leader(status, run.number, block.leader, datagram_);
  if (run.next == block.last_packet())
    return wire::encode_trailer(status, run.number, run.next, {block.leader.payload_type, block.leader.height},
                                datagram_);
  const std::size_t begin = (run.next - 1) * block.data_bytes;
  const std::size_t size = std::min(block.data_bytes, block.payload.size() - begin);
  wire::encode_data(status, run.number, run.next, wire::ByteSpan(block.payload).subspan(begin, size), datagram_);
}

void StreamSender::send_next(Run& run) {
  encode(run);
  if (run.again) ++(run.block ? statistics_.packets_resent : statistics_.packets_unavailable);
  ++run.next;
  // One uniform number a fault and packet, whatever the probabilities: a fault does not move the others.
  const double loss = random_.uniform(), duplicate = random_.uniform(), reorder = random_.uniform();
  if (loss < faults_.loss) {
    ++statistics_.packets_lost;
    return;
  }
  if (reorder < faults_.reorder && delayed_.empty()) {
    delayed_ = datagram_;
    return;
  }
  transmit(datagram_);
  if (duplicate < faults_.duplicate) transmit(datagram_);
  if (!delayed_.empty()) transmit(std::exchange(delayed_, {}));
}

void StreamSender::transmit(const wire::Bytes& datagram) {
  if (channel_.destination.port() == 0) return;
  ++statistics_.packets;
  error_code ignored;  // a packet that the system does not take is lost, as on a wire
  socket_.send_to(asio::buffer(datagram), channel_.destination, 0, ignored);
}

void StreamSender::send_test_packet(bool do_not_fragment) {
  if (is_silent_) return;
  const int discovery = do_not_fragment ? IP_PMTUDISC_DO : IP_PMTUDISC_DONT;
  ::setsockopt(socket_.native_handle(), IPPROTO_IP, IP_MTU_DISCOVER, &discovery, sizeof discovery);
  wire::Bytes packet(channel_.packet_size - 28);
  for (std::size_t k = 0; k < packet.size(); ++k) packet[k] = static_cast<std::uint8_t>(k);
  transmit(packet);
}

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
  delayed_frame_.reset();
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
  frame.leader.timestamp_ticks = ticks();
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

std::uint64_t Acquisition::ticks() const {
  return static_cast<std::uint64_t>(std::chrono::nanoseconds(Clock::now() - epoch_).count());
}

void Acquisition::read_out(std::shared_ptr<const Frame> frame) {
  if (const auto late = std::exchange(delayed_frame_, nullptr)) send(*late);
  if (delayed_frames_ > 0) {
    --delayed_frames_;
    ++statistics_.frames_delayed;
    if (!delays_all_) send(*frame);
    delayed_frame_ = std::move(frame);
  } else if (lost_frames_ > 0) {
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
