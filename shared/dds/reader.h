#pragma once

#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "shared/dds/bus.h"

namespace soffit {

template <class Topic>
struct ReaderHandlers {
  std::function<void(typename Topic::Value)> on_value;
  std::function<void(int writers)>
      on_writers;  ///< Optional. How many writers are matched (kState: and alive), at each change.
};

/// Receives the values of one topic, on the thread of its participant (see Participant). A message that is
/// not valid is reported as a problem and dropped.
template <class Topic>
class Reader {
 public:
  /// @param name  Of the topic, where one kind of value comes from several.
  /// Throws std::runtime_error when the library refuses to make it.
  Reader(const Participant& participant, ReaderHandlers<Topic> handlers,
         const std::string& name = Topic::kName)
      : core_(std::make_unique<Core>(participant.bus(), name, std::move(handlers))) {}
  Reader(const Participant& participant, std::function<void(typename Topic::Value)> on_value,
         const std::string& name = Topic::kName)
      : Reader(participant, ReaderHandlers<Topic>{std::move(on_value), {}}, name) {}

  int matched_writers() const { return core_->matched(); }
  bool WaitForWriter(std::chrono::milliseconds timeout) { return core_->WaitForMatch(timeout); }

 private:
  using ReturnCode = eprosima::fastrtps::types::ReturnCode_t;
  using StatusMask = eprosima::fastdds::dds::StatusMask;

  struct Core : dds_internal::Endpoint {
    Core(std::shared_ptr<dds_internal::Bus> its_bus, const std::string& its_topic,
         ReaderHandlers<Topic> its_handlers)
        : bus(std::move(its_bus)),
          topic(its_topic),
          handlers(std::move(its_handlers)),
          reader(bus->MakeReader(topic,
                                 eprosima::fastdds::dds::TypeSupport(
                                     new dds_internal::GuardedSupport<typename Topic::Support>()),
                                 Topic::kKind)) {
      auto& condition = reader->get_statuscondition();
      StatusMask statuses = StatusMask::none();
      statuses << StatusMask::data_available() << StatusMask::subscription_matched()
               << StatusMask::liveliness_changed() << StatusMask::requested_incompatible_qos();
      condition.set_enabled_statuses(statuses);
      bus->Attach(condition, *this);
    }
    ~Core() override {
      bus->Withdraw(reader->get_statuscondition());
      bus->Remove(reader);
    }

    void Serve() override {
      eprosima::fastdds::dds::RequestedIncompatibleQosStatus misfit;
      if (reader->get_requested_incompatible_qos_status(misfit) == ReturnCode::RETCODE_OK &&
          misfit.total_count_change > 0) {
        bus->ReportMisfits(*reader);
      }
      CountWriters();
      TakeAll();
    }

    void CountWriters() {
      eprosima::fastdds::dds::SubscriptionMatchedStatus match;
      eprosima::fastdds::dds::LivelinessChangedStatus liveliness;
      if (reader->get_subscription_matched_status(match) == ReturnCode::RETCODE_OK)
        this->SetMatched(match.current_count);
      int writers = this->matched();
      if constexpr (Topic::kKind == TopicKind::kState) {
        if (reader->get_liveliness_changed_status(liveliness) == ReturnCode::RETCODE_OK)
          writers = liveliness.alive_count;
      }
      if (std::exchange(known_writers, writers) != writers && handlers.on_writers)
        handlers.on_writers(writers);
    }

    void TakeAll() {
      typename Topic::Support::type message;
      eprosima::fastdds::dds::SampleInfo info;
      while (reader->take_next_sample(&message, &info) == ReturnCode::RETCODE_OK) {
        if (!info.valid_data) continue;
        auto value = Topic::FromWire(message);
        if (value.ok()) {
          handlers.on_value(std::move(value).value());
        } else {
          bus->Report(topic + ": refused a message: " + value.error().message);
        }
      }
    }

    std::shared_ptr<dds_internal::Bus> bus;
    std::string topic;
    ReaderHandlers<Topic> handlers;
    eprosima::fastdds::dds::DataReader* reader;
    int known_writers = 0;
  };

  std::unique_ptr<Core> core_;
};

}  // namespace soffit
