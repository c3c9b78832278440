/* dis/pdu/pdu.c: identifiers as text, names, arrival times. */
#include "dis/pdu/pdu.h"

#include <stdio.h>

static int three_way(unsigned a, unsigned b) { return (a > b) - (a < b); }

int dis_entity_id_compare(DisEntityId a, DisEntityId b)
{
    if (a.site != b.site) return three_way(a.site, b.site);
    if (a.application != b.application) return three_way(a.application, b.application);
    return three_way(a.entity, b.entity);
}

bool dis_entity_id_is_none(DisEntityId id) { return id.site == 0 && id.application == 0 && id.entity == 0; }

void dis_entity_id_text(char out[dis_id_text_size], DisEntityId id)
{
    snprintf(out, dis_id_text_size, "%u:%u:%u", id.site, id.application, id.entity);
}

/* Parses digits only: no sign, no blanks, not empty. */
static const char *parse_u16(uint16_t *out, const char *text)
{
    unsigned value = 0;
    if (*text < '0' || *text > '9') return NULL;
    for (; *text >= '0' && *text <= '9'; text++) {
        value = 10 * value + (unsigned)(*text - '0');
        if (value > UINT16_MAX) return NULL;
    }
    *out = (uint16_t)value;
    return text;
}

bool dis_entity_id_parse(DisEntityId *out, const char *text)
{
    DisEntityId id;
    text = parse_u16(&id.site, text);
    if (!text || *text != ':') return false;
    text = parse_u16(&id.application, text + 1);
    if (!text || *text != ':') return false;
    text = parse_u16(&id.entity, text + 1);
    if (!text || *text) return false;
    *out = id;
    return true;
}

void dis_entity_type_text(char out[dis_type_text_size], DisEntityType type)
{
    snprintf(out, dis_type_text_size, "%u.%u.%u.%u.%u.%u.%u", type.kind, type.domain, type.country, type.category,
             type.subcategory, type.specific, type.extra);
}

const char *dis_drop_name(DisDrop drop)
{
    static const char *const name[DIS_DROP_COUNT] = {
        [DIS_DROP_SHORT_HEADER] = "short_header",
        [DIS_DROP_BAD_VERSION] = "bad_version",
        [DIS_DROP_LENGTH_ZERO] = "length_zero",
        [DIS_DROP_LENGTH_TOO_SHORT] = "length_too_short",
        [DIS_DROP_LENGTH_TOO_LONG] = "length_too_long",
        [DIS_DROP_TRUNCATED] = "truncated",
        [DIS_DROP_BAD_COUNT] = "bad_count",
        [DIS_DROP_NOT_FINITE] = "not_finite",
        [DIS_DROP_BAD_POSITION] = "bad_position",
        [DIS_DROP_NO_IDENTITY] = "no_identity",
        [DIS_DROP_OTHER_EXERCISE] = "other_exercise",
        [DIS_DROP_TABLE_FULL] = "table_full",
    };
    return (unsigned)drop < DIS_DROP_COUNT ? name[drop] : "unknown";
}

const char *dis_drop_cause(DisDrop drop)
{
    static const char *const cause[DIS_DROP_COUNT] = {
        [DIS_DROP_SHORT_HEADER] = "fewer octets than a PDU header",
        [DIS_DROP_BAD_VERSION] = "a protocol version other than 5, 6 or 7",
        [DIS_DROP_LENGTH_ZERO] = "a length field of 0",
        [DIS_DROP_LENGTH_TOO_SHORT] = "a length field below what its PDU type needs",
        [DIS_DROP_LENGTH_TOO_LONG] = "a length field beyond the end of the datagram",
        [DIS_DROP_TRUNCATED] = "a record that ends before its fields do",
        [DIS_DROP_BAD_COUNT] = "a count of records that its length cannot hold",
        [DIS_DROP_NOT_FINITE] = "a position or attitude that is not a number",
        [DIS_DROP_BAD_POSITION] = "a position that is not near the Earth",
        [DIS_DROP_NO_IDENTITY] = "an entity id that names no single entity",
        [DIS_DROP_OTHER_EXERCISE] = "another exercise id",
        [DIS_DROP_TABLE_FULL] = "a full entity table",
    };
    return (unsigned)drop < DIS_DROP_COUNT ? cause[drop] : "unknown";
}

int64_t dis_unix_ns_until(double unix_s)
{
    static const double most_s = 9e9;
    if (!(unix_s > 0)) return unix_s == 0 ? 0 : -1;
    if (unix_s >= most_s) return (int64_t)most_s * 1000000000;
    /* doubles lie at most 2 us apart here, so the result is within this of the first estimate */
    const int64_t around = 4096, whole_s = (int64_t)unix_s;
    const int64_t guess = whole_s * 1000000000 + (int64_t)((unix_s - (double)whole_s) * 1e9);
    int64_t       low = guess > around ? guess - around : 0, high = guess + around;
    while (low < high) { /* searches the last nanosecond that is not after unix_s */
        const int64_t middle = high - (high - low) / 2;
        if (dis_unix_s(middle) <= unix_s) low = middle;
        else high = middle - 1;
    }
    return low;
}
