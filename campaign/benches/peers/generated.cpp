// Times of straight-line C that CasADi generated for this arm alone (see generated.py, problem.hpp).
#include <cmath>

#include "problem.hpp"

namespace generated {
#include "generated.c"
}

// Outputs of one call, column by column.
struct Outputs {
    double parts[7][JOINTS * JOINTS];
    double* addresses[7];
    Outputs() {
        for (int i = 0; i < 7; ++i) addresses[i] = parts[i];
    }
};

int main(int, char** argv) {
    const std::vector<State> states = read_states(argv[1]);
    static Outputs out;
    const auto call = [&](auto function, const State& s) {
        const double* inputs[] = {s.q, s.qd, s.qdd};
        function(inputs, out.addresses, nullptr, nullptr, 0);
        keep(out);
    };
    const auto rnea = [&](const State& s) { call(generated::generated_rnea, s); };
    const auto crba = [&](const State& s) { call(generated::generated_crba, s); };
    const auto jacobian_drift = [&](const State& s) { call(generated::generated_jacobian_drift, s); };
    const auto control_terms = [&](const State& s) { call(generated::generated_control_terms, s); };
    if (!std::strcmp(argv[2], "time")) {
        time_calls("rnea", states, rnea);
        time_calls("crba", states, crba);
        time_calls("jacobian_drift", states, jacobian_drift);
        time_calls("control_terms", states, control_terms);
        return 0;
    }
    for (size_t k = 0; k < CHECKED; ++k) {
        rnea(states[k]);
        print_values("rnea", k, out.parts[0], JOINTS);
        crba(states[k]);
        print_values("crba", k, out.parts[0], JOINTS * JOINTS);
        jacobian_drift(states[k]);
        print_values("jacobian", k, out.parts[2], 6 * JOINTS);
        print_values("jacobian_drift", k, out.parts[3], 6);
        control_terms(states[k]);
        double all[JOINTS * JOINTS + JOINTS];
        std::copy_n(out.parts[4], JOINTS * JOINTS, all);
        for (int j = 0; j < JOINTS; ++j) all[JOINTS * JOINTS + j] = out.parts[5][j] + out.parts[6][j];
        print_values("control_terms", k, all, JOINTS * JOINTS + JOINTS);
    }
}
