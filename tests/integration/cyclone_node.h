#pragma once

// Nodes of ROS 2 as far as DDS sees them: Cyclone DDS over loopback, in no partition.
#define _DEFAULT_SOURCE  // setenv
#include <dds/dds.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "messages.h"

static inline dds_entity_t must(dds_entity_t result, const char* what) {
  if (result >= 0) return result;
  fprintf(stderr, "%s: %s\n", what, dds_strretcode(-result));
  exit(3);
}

static inline dds_entity_t join(const char* domain) {
  setenv(
      "CYCLONEDDS_URI",
      "<General><Interfaces><NetworkInterface name='lo' multicast='true'/></Interfaces></General>",
      1);
  return must(dds_create_participant((dds_domainid_t)atoi(domain), NULL, NULL), "participant");
}

// Of the topic /name, with the QoS of nodes, once somebody reads it.
static inline dds_entity_t make_writer(dds_entity_t node, const dds_topic_descriptor_t* type,
                                       const char* name, bool reliable) {
  char whole[256];
  snprintf(whole, sizeof whole, "rt/%s", name);
  const dds_entity_t topic = must(dds_create_topic(node, type, whole, NULL, NULL), "topic");
  dds_qos_t* qos = dds_create_qos();
  dds_qset_reliability(qos, reliable ? DDS_RELIABILITY_RELIABLE : DDS_RELIABILITY_BEST_EFFORT,
                       DDS_SECS(1));
  dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, 10);
  const dds_entity_t writer = must(dds_create_writer(node, topic, qos, NULL), "writer");
  dds_delete_qos(qos);
  dds_publication_matched_status_t matched = {0};
  while (matched.current_count == 0) {
    dds_sleepfor(DDS_MSECS(10));
    must(dds_get_publication_matched_status(writer, &matched), "status");
  }
  return writer;
}
