#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/Topic.hpp>
#include <iostream>
#include <string>

#include "soffitPubSubTypes.h"

using namespace eprosima::fastdds::dds;

int main(int argc, char** argv) {
  if (argc != 2) return 2;  // The domain.
  auto* factory = DomainParticipantFactory::get_instance();
  auto* participant = factory->create_participant(std::stoi(argv[1]), PARTICIPANT_QOS_DEFAULT);
  TypeSupport type(new soffit::wire::SceneObjectPubSubType());
  type.register_type(participant);
  auto* topic = participant->create_topic("soffit/scene_object/v1", type.get_type_name(), TOPIC_QOS_DEFAULT);
  auto* subscriber = participant->create_subscriber(SUBSCRIBER_QOS_DEFAULT);
  DataReaderQos qos;
  qos.reliability().kind = RELIABLE_RELIABILITY_QOS;
  qos.durability().kind = TRANSIENT_LOCAL_DURABILITY_QOS;  // What was published before we came.
  qos.endpoint().history_memory_policy = eprosima::fastrtps::rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
  auto* reader = subscriber->create_datareader(topic, qos);
  soffit::wire::SceneObject object;
  SampleInfo info;
  while (reader->wait_for_unread_message({10, 0})) {
    if (reader->take_next_sample(&object, &info) != ReturnCode_t::RETCODE_OK || !info.valid_data) continue;
    std::cout << "building " << object.object_id() << ", " << object.color() << ", " << object.height_m()
              << " m high" << std::endl;
  }
  participant->delete_contained_entities();
  return factory->delete_participant(participant) == ReturnCode_t::RETCODE_OK ? 0 : 1;
}
