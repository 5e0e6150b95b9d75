// Times of MuJoCo's functions on INPUTS/arm.xml (see problem.hpp).
#include <mujoco/mujoco.h>

#include "problem.hpp"

int main(int, char** argv) {
    char error[1000] = "";
    mjModel* m = mj_loadXML((std::string(argv[1]) + "/arm.xml").c_str(), nullptr, error, sizeof error);
    if (!m || m->nv != JOINTS) {
        std::fprintf(stderr, "%s\n", error);
        return 2;
    }
    mjData* d = mj_makeData(m);
    const std::vector<State> states = read_states(argv[1]);
    const int site = mj_name2id(m, mjOBJ_SITE, "flange"), body = m->site_bodyid[site];
    mjtNum linear[3 * JOINTS], angular[3 * JOINTS], drift[6], mass[JOINTS * JOINTS], bias_torque[JOINTS];

    const auto place = [&](const State& s) {
        mju_copy(d->qpos, s.q, JOINTS);
        mju_copy(d->qvel, s.qd, JOINTS);
    };
    const auto rnea = [&](const State& s) {
        place(s);
        mju_copy(d->qacc, s.qdd, JOINTS);
        mj_inverse(m, d);
        keep(d->qfrc_inverse[0]);
    };
    const auto crba = [&](const State& s) {
        place(s);
        mj_kinematics(m, d);
        mj_comPos(m, d);
        mj_makeM(m, d);
        mj_fullM(m, d, mass);
        keep(mass);
    };
    const auto aba = [&](const State& s) {
        place(s);
        mju_copy(d->qfrc_applied, s.tau, JOINTS);
        mj_forward(m, d);
        keep(d->qacc[0]);
    };
    const auto bias = [&](const State& s) {
        place(s);
        mj_kinematics(m, d);
        mj_comPos(m, d);
        mj_comVel(m, d);
        mj_rne(m, d, 0, bias_torque);
        keep(bias_torque);
    };
    const auto jacobian = [&](const State& s) {
        place(s);
        mj_kinematics(m, d);
        mj_comPos(m, d);
        mj_jacSite(m, d, linear, angular, site);
        keep(linear);
        keep(angular);
    };
    const auto add_drift = [&](const State& s) {
        mjtNum linear_dot[3 * JOINTS], angular_dot[3 * JOINTS];
        mj_comVel(m, d);
        mj_jacDot(m, d, linear_dot, angular_dot, d->site_xpos + 3 * site, body);
        mju_mulMatVec(drift, angular_dot, s.qd, 3, JOINTS);
        mju_mulMatVec(drift + 3, linear_dot, s.qd, 3, JOINTS);
        keep(drift);
    };
    const auto jacobian_drift = [&](const State& s) {
        jacobian(s);
        add_drift(s);
    };
    const auto control_terms = [&](const State& s) {
        jacobian_drift(s);
        mj_makeM(m, d);
        mj_fullM(m, d, mass);
        mj_rne(m, d, 0, bias_torque);
        keep(mass);
        keep(bias_torque);
    };

    if (!std::strcmp(argv[2], "time")) {
        time_calls("rnea", states, rnea);
        time_calls("crba", states, crba);
        time_calls("aba", states, aba);
        time_calls("bias", states, bias);
        time_calls("jacobian", states, jacobian);
        time_calls("jacobian_drift", states, jacobian_drift);
        time_calls("control_terms", states, control_terms);
        // A control period of 1 ms in five steps, Euler (implicit in the damping), 0.5 Nm s/rad in every joint.
        for (int i = 0; i < m->nv; ++i) m->dof_damping[i] = 0.5;
        m->opt.integrator = mjINT_EULER;
        m->opt.timestep = 2e-4;
        const auto prepare = [&](const State& s) {
            mj_resetData(m, d);
            place(s);
            mju_scl(d->qfrc_applied, s.tau, 0.01, JOINTS);
        };
        time_each("period_of_five_steps", states, prepare, [&](const State&) {
            for (int step = 0; step < 5; ++step) mj_step(m, d);
            keep(d->qpos[0]);
        });
        return 0;
    }
    for (size_t k = 0; k < CHECKED; ++k) {
        const State& s = states[k];
        rnea(s);
        print_values("rnea", k, d->qfrc_inverse, JOINTS);
        mj_resetData(m, d);
        aba(s);
        print_values("aba", k, d->qacc, JOINTS);
        mj_resetData(m, d);
        control_terms(s);
        print_values("crba", k, mass, JOINTS * JOINTS);
        print_values("bias", k, bias_torque, JOINTS);
        double turned[6 * JOINTS], all[56];
        for (int j = 0; j < JOINTS; ++j)
            for (int r = 0; r < 3; ++r) {
                turned[6 * j + r] = angular[JOINTS * r + j];
                turned[6 * j + 3 + r] = linear[JOINTS * r + j];
            }
        print_values("jacobian", k, turned, 6 * JOINTS);
        print_values("jacobian_drift", k, drift, 6);
        std::copy(mass, mass + 49, all);
        std::copy(bias_torque, bias_torque + 7, all + 49);
        print_values("control_terms", k, all, 56);
    }
}
