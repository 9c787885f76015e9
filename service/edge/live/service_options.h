#pragma once

#include <string>

#include "service/mission/mission.h"
#include "service/pipeline/pipeline.h"
#include "shared/dds/participant.h"
#include "shared/options/options.h"

namespace soffit {

/// Everything that the ground service can be told, in its one YAML file.
struct ServiceOptions {
  DdsOptions radio = DefaultRadioOptions();
  DdsOptions local = DefaultLocalOptions();
  std::string data_folder = "soffit-data";
  std::string store;
  int workers = 2;
  int max_waiting_pictures = 32;
  MissionOptions mission;
  PipelineOptions pipeline;

  template <class Self, class Visitor>
  static void Visit(Self& self, Visitor&& field) {
    field("radio", self.radio);
    field("local", self.local);
    field("data_folder", self.data_folder,
          OptionInfo{0, 0, "", "Each mission keeps its pictures and results in a folder below it"});
    field(
        "store", self.store,
        OptionInfo{0, 0, "",
                   "Where missions are kept: a GeoPackage file, or 'PG:' and a connection string of PostGIS; "
                   "empty: soffit.gpkg in the data folder"});
    field("workers", self.workers, OptionInfo{1, 256, "", "Threads that work on pictures"});
    field("max_waiting_pictures", self.max_waiting_pictures,
          OptionInfo{1, 10000, "", "More are refused, and taken again"});
    field("mission", self.mission);
    field("pipeline", self.pipeline);
  }
};

}  // namespace soffit
