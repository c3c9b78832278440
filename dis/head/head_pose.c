/* dis/head/head_pose.c: octets of a head tracker's datagram. */
#include "dis/head/head_pose.h"

#include "dis/pdu/octets.h"

const char *const head_drop_name[HEAD_DROPS] = {
    [HEAD_GOOD] = "good",   [HEAD_SIZE] = "size",   [HEAD_MAGIC] = "magic", [HEAD_VERSION] = "version",
    [HEAD_FLAGS] = "flags", [HEAD_RANGE] = "range", [HEAD_OLD] = "old",
};

static const uint8_t magic[4] = {'P', 'V', 'H', 'D'};

static bool within(double v, double low, double high) { return v >= low && v <= high; } /* false of NaN */

static bool in_range(const HeadPose *p)
{
    return within(p->yaw_deg, -360, 360) && within(p->pitch_deg, -90, 90) && within(p->roll_deg, -360, 360) &&
           within(p->zoom, 0.05, 100) && within(p->lat_deg, -90, 90) && within(p->lon_deg, -360, 360) &&
           within(p->height_m, -1e3, 1e5);
}

HeadDrop head_pose_read(HeadPose *out, const uint8_t *octets, size_t count)
{
    DisReader r = {.at = octets, .end = octets + count};
    uint8_t   begin[sizeof magic];
    HeadPose  p = {0};
    float     number[4];
    if (count != head_octets && count != head_octets_placed) return HEAD_SIZE;
    dis_read_octets(begin, &r, sizeof begin);
    if (memcmp(begin, magic, sizeof magic) != 0) return HEAD_MAGIC;
    if (dis_read_u16(&r) != head_version) return HEAD_VERSION;
    p.flags = dis_read_u16(&r);
    if (p.flags & ~(unsigned)(HEAD_PLACED | HEAD_RELATIVE)) return HEAD_FLAGS;
    if (count != (p.flags & HEAD_PLACED ? head_octets_placed : head_octets)) return HEAD_SIZE;
    p.sequence = dis_read_u32(&r);
    p.buttons = dis_read_u32(&r);
    p.time_us = (uint64_t)dis_read_u32(&r) << 32;
    p.time_us |= dis_read_u32(&r);
    dis_read_f32(number, &r, 4);
    p.yaw_deg = (double)number[0];
    p.pitch_deg = (double)number[1];
    p.roll_deg = (double)number[2];
    p.zoom = (double)number[3];
    if (p.flags & HEAD_PLACED) {
        double place[3];
        dis_read_f64(place, &r, 3);
        p.lat_deg = place[0];
        p.lon_deg = place[1];
        p.height_m = place[2];
    }
    if (!in_range(&p)) return HEAD_RANGE;
    *out = p;
    return HEAD_GOOD;
}

size_t head_pose_write(uint8_t out[head_octets_most], const HeadPose *p)
{
    const float number[4] = {(float)p->yaw_deg, (float)p->pitch_deg, (float)p->roll_deg, (float)p->zoom};
    memcpy(out, magic, sizeof magic);
    dis_store_u16(out + 4, head_version);
    dis_store_u16(out + 6, (uint16_t)p->flags);
    dis_store_u32(out + 8, p->sequence);
    dis_store_u32(out + 12, p->buttons);
    dis_store_u32(out + 16, (uint32_t)(p->time_us >> 32));
    dis_store_u32(out + 20, (uint32_t)p->time_us);
    for (int k = 0; k < 4; k++) dis_store_f32(out + 24 + 4 * k, &number[k]);
    if (!(p->flags & HEAD_PLACED)) return head_octets;
    dis_store_f64(out + 40, &p->lat_deg);
    dis_store_f64(out + 48, &p->lon_deg);
    dis_store_f64(out + 56, &p->height_m);
    return head_octets_placed;
}

bool head_newer(uint32_t sequence, uint32_t than)
{
    const int32_t ahead = (int32_t)(sequence - than);
    return ahead > 0 || ahead < -head_back;
}
