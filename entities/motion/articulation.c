/* entities/motion/articulation.c: articulated parts by class and metric. See the header for signs and keys. */
#include "entities/motion/articulation.h"

/* Classes are multiples of 32 and the metric sits in the low five bits. 1024 (rudder) is the first class of
 * SISO-REF-010 and its tables end below 8192 (from memory). A sender known to shift the class twice puts 131083
 * where 4107 was meant: that is no class, and guessing would turn another sender's part. */
static const uint32_t first_class = 1024, end_class = 8192;

static const double largest_rate = 100; /* rad/s or m/s; larger rates are not followed. Guns slew at 1 */

static bool metric_is_rate(uint32_t metric) { return metric % 2 == 0; }
static bool metric_is_angle(uint32_t metric) { return metric >= 11; }

/* Splits a parameter into class and metric; returns false when it names no class or no metric. */
static bool split_parameter(uint32_t *dis_class, uint32_t *metric, uint32_t parameter)
{
    *dis_class = parameter & ~UINT32_C(31);
    *metric = parameter & 31;
    return *dis_class >= first_class && *dis_class < end_class && *metric >= 1 && *metric <= 16;
}

static int joint_position(const Articulation *articulation, uint32_t parameter)
{
    int low = 0, high = articulation->count;
    while (low < high) {
        const int middle = (low + high) / 2;
        if (articulation->joint[middle].parameter < parameter) low = middle + 1;
        else high = middle;
    }
    return low;
}

/* The joint of a value's parameter; it is added with value 0 when absent. NULL: there is no room. */
static JointReport *joint_for(Articulation *articulation, uint32_t parameter)
{
    const int    at = joint_position(articulation, parameter);
    JointReport *joint = articulation->joint + at;

    if (at < articulation->count && joint->parameter == parameter) return joint;
    if (articulation->count == articulation_max_joints) return NULL;
    memmove(joint + 1, joint, (size_t)(articulation->count - at) * sizeof *joint);
    articulation->count++;
    *joint = (JointReport){.parameter = parameter};
    return joint;
}

/* Brings an angle to -pi .. pi. remainder() is used only for very large angles, since it is 20 times slower; the usual
 * way is within 1e-10 rad for an hour of any rotor. */
static double wrapped(double angle_rad)
{
    if (!(fabs(angle_rad) <= 1e8)) return remainder(angle_rad, 2 * pi_rad);
    return angle_rad - 2 * pi_rad * rint(angle_rad / (2 * pi_rad));
}

static double joint_value_at(const JointReport *joint, double dt_s, double hold_s)
{
    return joint->value + joint->rate * clamp(dt_s, -hold_s, hold_s);
}

int articulation_report(Articulation *articulation, const DisVariableParameter *record, int count, double t_s,
                        double hold_s)
{
    int ignored = 0;

    for (int j = 0; j < articulation->count; j++) {
        JointReport *joint = articulation->joint + j;
        joint->value = (float)joint_value_at(joint, t_s - articulation->t_s, hold_s);
        joint->rate = 0;
    }
    articulation->t_s = t_s;
    articulation->attached_count = 0;

    for (int i = 0; i < count; i++) {
        uint32_t dis_class, metric;
        if (record[i].record_type == dis_variable_attached && record[i].change == 0) articulation->attached_count++;
        if (record[i].record_type != dis_variable_articulated) continue;
        if (!split_parameter(&dis_class, &metric, record[i].parameter)) {
            ignored++;
            continue;
        }
        if (!isfinite(record[i].value)) continue;
        JointReport *joint = joint_for(articulation, dis_class + (metric_is_rate(metric) ? metric - 1 : metric));
        if (!joint) ignored++;
        else if (!metric_is_rate(metric)) joint->value = record[i].value;
        else if (fabs(record[i].value) <= largest_rate) joint->rate = record[i].value;
    }
    return ignored;
}

bool articulation_value(double *value, const Articulation *articulation, uint32_t dis_class, uint32_t dis_metric,
                        double t_s, double hold_s)
{
    const uint32_t parameter = dis_class + dis_metric;
    const int      at = joint_position(articulation, parameter);

    if (at == articulation->count || articulation->joint[at].parameter != parameter) return false;
    const double v = joint_value_at(articulation->joint + at, t_s - articulation->t_s, hold_s);
    *value = metric_is_angle(dis_metric) ? wrapped(v) : v;
    return true;
}

/* A sender may report 350 degrees where the joint's limits are -10 .. 20. */
static double turn_into_limits(double angle_rad, double low, double high)
{
    if (low > high) return angle_rad;
    if (angle_rad < low && angle_rad + 2 * pi_rad <= high) return angle_rad + 2 * pi_rad;
    if (angle_rad > high && angle_rad - 2 * pi_rad >= low) return angle_rad - 2 * pi_rad;
    return angle_rad;
}

void articulation_joint_values(double *value, const Model *model, const Articulation *articulation,
                               const JointDrive *drive, double t_s, double hold_s)
{
    for (int n = 0; n < model->node_count; n++) {
        const ModelNode *node = model->node + n;

        value[n] = 0;
        if (node->dis_class &&
            articulation_value(value + n, articulation, node->dis_class, node->dis_metric, t_s, hold_s)) {
            if (node->dis_scale != 0) value[n] *= node->dis_scale;
            if (node->joint == JOINT_ROTATION) value[n] = turn_into_limits(value[n], node->low, node->high);
        } else if (node->spin_rps_moving != 0) {
            value[n] = wrapped(node->spin_rps_moving * drive->spin_s);
        } else if (node->roll_radius_m > 0) {
            value[n] = wrapped(drive->distance_m / node->roll_radius_m);
        } else if (drive->speed_mps < articulation_slow_mps) {
            value[n] = node->value_slow;
        }
    }
}
