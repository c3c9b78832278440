/* sensor/commands/inspect_tsv.c: one line per Entity State.
 *
 * The lines are those of `tshark -T fields`, column names and number formats too, so that the two programs can be
 * compared. */
#include "sensor/commands/inspect_private.h"

#include "dis/datagram.h"
#include "dis/decode.h"

#include <stdio.h>

static const char tsv_header[] =
    "frame.number\tdis.proto_ver\tdis.exer_id\tdis.timestamp\tdis.pdu_length\tdis.entity_id_site\t"
    "dis.entity_id_application\tdis.entity_id_entity\tdis.force_id\tdis.num_articulation_params\t"
    "dis.entity_linear_velocity.x\tdis.entity_linear_velocity.y\tdis.entity_linear_velocity.z\t"
    "dis.entity_location.x\tdis.entity_location.y\tdis.entity_location.z\tdis.entity_orientation.psi\t"
    "dis.entity_orientation.theta\tdis.entity_orientation.phi\tdis.appearance\tdis.entity_linear_acceleration.x\t"
    "dis.entity_linear_acceleration.y\tdis.entity_linear_acceleration.z\tdis.entity_angular_velocity.x\t"
    "dis.entity_angular_velocity.y\tdis.entity_angular_velocity.z\tdis.entity_marking";
static const char tsv_full_header[] =
    "\tdis.entityKind\tdis.entityDomain\tdis.country\tdis.category\tdis.subcategory\tdis.specific\tdis.extra\t"
    "dis.dead_reckoning_algorithm\tdis.dead_reckoning_other_parameters\tdis.capabilities\talternative_type\t"
    "articulation";

/* tshark divides by 2^31 - 1 and cuts to microseconds, here in integers; it is up to 1.7 us ahead of
 * dis_timestamp_seconds, and printed for comparison only. */
static void print_stamp(uint32_t timestamp)
{
    const uint64_t us = (uint64_t)(timestamp >> 1) * 3600000000u / 0x7FFFFFFF;
    printf("\t%llu.%06llu000", (unsigned long long)(us / 1000000), (unsigned long long)(us % 1000000));
}

static void print_floats(const float v[3])
{
    for (int i = 0; i < 3; i++) printf("\t%.6g", (double)v[i]);
}

static void print_full(const DisEntityState *es)
{
    printf("\t%u\t%u\t%u\t%u\t%u\t%u\t%u\t%u\t", es->type.kind, es->type.domain, es->type.country, es->type.category,
           es->type.subcategory, es->type.specific, es->type.extra, es->dead_reckoning);
    for (size_t i = 0; i < sizeof es->dead_reckoning_other; i++) printf("%02x", es->dead_reckoning_other[i]);
    char alternative[dis_type_text_size];
    dis_entity_type_text(alternative, es->alternative_type);
    printf("\t%u\t%s\t", es->capabilities, alternative);
    for (int i = 0; i < es->variable_count; i++) {
        const DisVariableParameter *v = &es->variable[i];
        if (i) putchar(';');
        if (v->record_type == dis_variable_articulated) {
            printf("%u:%u:%u:%.6g", v->change, v->attached_to, v->parameter, (double)v->value);
        } else if (v->record_type == dis_variable_attached) {
            char type[dis_type_text_size];
            dis_entity_type_text(type, v->type);
            printf("attached:%u:%u:%u:%s", v->change, v->attached_to, v->parameter, type);
        } else {
            printf("record:");
            for (size_t k = 0; k < sizeof v->octets; k++) printf("%02x", v->octets[k]);
        }
    }
}

static void print_tsv_row(uint32_t packet, const DisEntityState *es, bool full)
{
    char marking[64];
    text_escape(marking, sizeof marking, es->marking, strnlen(es->marking, sizeof es->marking));
    printf("%u\t%u\t%u", packet, es->header.version, es->header.exercise);
    print_stamp(es->header.timestamp);
    printf("\t%u\t%u\t%u\t%u\t%u\t%u", es->header.length, es->id.site, es->id.application, es->id.entity, es->force,
           es->variable_count);
    print_floats(es->velocity_mps);
    for (int i = 0; i < 3; i++) printf("\t%.15g", es->p_ecef[i]);
    print_floats((const float[3]){es->psi_rad, es->theta_rad, es->phi_rad});
    printf("\t0x%08x", es->appearance);
    print_floats(es->acceleration_mps2);
    print_floats(es->angular_rate_rps);
    printf("\t%s", marking);
    if (full) print_full(es);
    putchar('\n');
}

void inspect_tsv(const DisLog *log, const char *path, int exercise, bool full)
{
    static DisPdu decoded; /* 11 KiB, and the command has one thread */
    DisCounters   counters = {0};
    uint64_t      undecoded = 0;
    printf("%s%s\n", tsv_header, full ? tsv_full_header : "");
    for (int i = 0; i < log->count; i++) {
        const DisDatagram d = dis_log_datagram(log, i);
        const uint8_t     *at = d.bytes, *end = d.bytes + d.octets, *pdu;
        DisHeader          header;
        while (dis_next_pdu(&header, &pdu, &at, end, &counters)) {
            if (header.type != dis_pdu_entity_state) continue;
            if (exercise >= 0 && header.exercise != exercise) continue;
            if (dis_decode(&decoded, pdu, header.length) == STATUS_OK)
                print_tsv_row(d.packet, &decoded.entity_state, full);
            else
                undecoded++;
        }
    }
    for (int why = 0; why < DIS_DROP_COUNT; why++) undecoded += counters.dropped[why];
    if (undecoded)
        log_warn("inspect: PDUs left out as malformed: count=%llu; `pitviper inspect %s` says why",
                 (unsigned long long)undecoded, path);
}
