// What all programs that time a peer share: the inputs, the stopwatch, and how they answer.
//
//   PROGRAM INPUTS check    one line per call and state: name state values…
//   PROGRAM INPUTS time     one line per call: name nanoseconds
#pragma once
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <string>
#include <vector>

constexpr int JOINTS = 7;
constexpr int CHECKED = 20;
constexpr int PASSES = 21;

struct Link {
    double rotation[9], translation[3];  // of the joint in the link before, row by row
    double mass, com[3], inertia[9];     // about the centre of mass
};

struct Arm {
    Link links[JOINTS];
    double flange_rotation[9], flange_translation[3], gravity[3];
};

struct State {
    double q[JOINTS], qd[JOINTS], qdd[JOINTS], tau[JOINTS];
};

struct Instance {  // of FUNCTIONS §2: linear rows of J first
    double jacobian[6][JOINTS], torque[JOINTS], lower[JOINTS], upper[JOINTS], variance[JOINTS];
};

template <class T>
std::vector<T> read_all(const std::string& path) {
    std::ifstream file(path);
    std::vector<double> numbers;
    for (double x; file >> x;) numbers.push_back(x);
    constexpr size_t each = sizeof(T) / sizeof(double);
    if (numbers.empty() || numbers.size() % each) {
        std::fprintf(stderr, "%s: %zu numbers\n", path.c_str(), numbers.size());
        std::exit(2);
    }
    std::vector<T> all(numbers.size() / each);
    std::memcpy(all.data(), numbers.data(), numbers.size() * sizeof(double));
    return all;
}

inline Arm read_arm(const std::string& inputs) { return read_all<Arm>(inputs + "/arm.txt").at(0); }
inline std::vector<State> read_states(const std::string& inputs) { return read_all<State>(inputs + "/states.txt"); }

// The compiler must take `value` for used.
template <class T>
inline void keep(const T& value) {
    asm volatile("" : : "r"(&value) : "memory");
}

inline double seconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

inline double quantile(std::vector<double> times, double p) {
    std::sort(times.begin(), times.end());
    return times[size_t(p * double(times.size() - 1))];
}

// Median over passes of the mean over all inputs.
template <class T, class F>
void time_calls(const char* name, const std::vector<T>& inputs, F call) {
    std::vector<double> times;
    for (int pass = 0; pass <= PASSES; ++pass) {
        const double start = seconds();
        for (const T& input : inputs) call(input);
        if (pass) times.push_back((seconds() - start) / double(inputs.size()));
    }
    std::printf("%s %.3f\n", name, 1e9 * quantile(times, 0.5));
}

// Median (and 99th percentile) over inputs of the least of some passes, each call by itself; what `prepare` does is not counted.
template <class T, class P, class F>
void time_each(const char* name, const std::vector<T>& inputs, P prepare, F call) {
    std::vector<double> least(inputs.size(), 1e9);
    for (int pass = 0; pass < 5; ++pass)
        for (size_t k = 0; k < inputs.size(); ++k) {
            prepare(inputs[k]);
            const double start = seconds();
            call(inputs[k]);
            least[k] = std::min(least[k], seconds() - start);
        }
    std::printf("%s %.3f\n%s_p99 %.3f\n", name, 1e9 * quantile(least, 0.5), name, 1e9 * quantile(least, 0.99));
}

inline void print_values(const char* name, size_t state, const double* values, int count) {
    std::printf("%s %zu", name, state);
    for (int i = 0; i < count; ++i) std::printf(" %.17g", values[i]);
    std::printf("\n");
}
