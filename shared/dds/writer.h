#pragma once

#include <memory>
#include <string>

#include "shared/dds/bus.h"

namespace soffit {

/// Sends values of one topic. Thread-safe.
template <class Topic>
class Writer {
 public:
  using Value = typename Topic::Value;

  /// @param name  Of the topic, where one kind of value goes to several.
  /// Throws std::runtime_error when the library refuses to make it.
  explicit Writer(const Participant& participant, const std::string& name = Topic::kName)
      : core_(std::make_unique<Core>(participant.bus(), name)) {}

  /// False when the value was not taken: a kPicture topic whose link is full (drop the picture, or try again
  /// later), or a failure that `on_problem` was told. Returns soon (kPicture: within 50 ms).
  bool Write(const Value& value) {
    auto message = Topic::ToWire(value);
    const auto code = core_->writer->write(&message, eprosima::fastdds::dds::InstanceHandle_t());
    return core_->WasTaken(code);
  }

  /// Tells the readers that what `value` has the key of is no more.
  void Dispose(const Value& value) {
    auto message = Topic::ToWire(value);
    core_->writer->dispose(&message, eprosima::fastdds::dds::InstanceHandle_t());
  }

  /// False when a reader has not acknowledged everything within `timeout`.
  bool WaitForAcknowledgements(std::chrono::milliseconds timeout) {
    const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(timeout);
    const std::chrono::nanoseconds rest = timeout - seconds;
    return core_->writer->wait_for_acknowledgments(
               {static_cast<std::int32_t>(seconds.count()), static_cast<std::uint32_t>(rest.count())}) ==
           eprosima::fastrtps::types::ReturnCode_t::RETCODE_OK;
  }

  int matched_readers() const { return core_->matched(); }

  /// How many readers have left so far. When the number has changed since a value was written, its
  /// acknowledgement tells nothing of them.
  int CountDepartedReaders() { return core_->ReadMatches(); }
  bool WaitForReader(std::chrono::milliseconds timeout) { return core_->WaitForMatch(timeout); }

 private:
  using ReturnCode = eprosima::fastrtps::types::ReturnCode_t;
  using StatusMask = eprosima::fastdds::dds::StatusMask;

  struct Core : dds_internal::Endpoint {
    Core(std::shared_ptr<dds_internal::Bus> its_bus, const std::string& its_topic)
        : bus(std::move(its_bus)),
          topic(its_topic),
          writer(bus->MakeWriter(topic,
                                 eprosima::fastdds::dds::TypeSupport(
                                     new dds_internal::GuardedSupport<typename Topic::Support>()),
                                 Topic::kKind)) {
      auto& condition = writer->get_statuscondition();
      StatusMask statuses = StatusMask::none();
      statuses << StatusMask::publication_matched() << StatusMask::offered_incompatible_qos();
      condition.set_enabled_statuses(statuses);
      bus->Attach(condition, *this);
    }
    ~Core() override {
      bus->Withdraw(writer->get_statuscondition());
      bus->Remove(writer);
    }

    /// How many readers have left.
    int ReadMatches() {
      eprosima::fastdds::dds::PublicationMatchedStatus match;
      if (writer->get_publication_matched_status(match) == ReturnCode::RETCODE_OK)
        this->SetMatched(match.current_count);
      return match.total_count - match.current_count;
    }

    void Serve() override {
      ReadMatches();
      eprosima::fastdds::dds::OfferedIncompatibleQosStatus misfit;
      if (writer->get_offered_incompatible_qos_status(misfit) == ReturnCode::RETCODE_OK &&
          misfit.total_count_change > 0) {
        bus->ReportMisfits(*writer);
      }
    }

    bool WasTaken(const ReturnCode& code) const {
      if (code == ReturnCode::RETCODE_OK) return true;
      const bool is_full = code == ReturnCode::RETCODE_TIMEOUT && Topic::kKind == TopicKind::kPicture;
      if (!is_full)
        bus->Report(topic + ": could not be sent (DDS return code " + std::to_string(code()) + ")");
      return false;
    }

    std::shared_ptr<dds_internal::Bus> bus;
    std::string topic;
    eprosima::fastdds::dds::DataWriter* writer;
  };

  std::unique_ptr<Core> core_;
};

}  // namespace soffit
