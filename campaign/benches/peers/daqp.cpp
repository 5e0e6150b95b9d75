// Times of DAQP on the force-estimation programmes of FUNCTIONS §2 in 7 variables (see problem.hpp).
//
//   minimise ½ t'H t + c't over lower <= t <= upper,  H = 2 (Re + J'RF J)^-1,  c = -H tau,  F = K (tau - t)
//
// `qp_…` is DAQP alone: its factorisation of a given H, its solution. `estimate…` counts what is around it too, in Eigen's
// fixed sizes, as a program would that is given tau, J and the band: this is what ours does.
#include <api.h>
#include <utils.h>

#include <Eigen/Dense>

#include "problem.hpp"

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Matrix7 = Eigen::Matrix<double, 7, 7, Eigen::RowMajor>;
using Matrix67 = Eigen::Matrix<double, 6, 7, Eigen::RowMajor>;
using Vector6 = Eigen::Matrix<double, 6, 1>;
using Vector7 = Eigen::Matrix<double, 7, 1>;
constexpr double LAMBDA = 1.96;
constexpr int ALL = DAQP_UPDATE_Rinv | DAQP_UPDATE_M | DAQP_UPDATE_v | DAQP_UPDATE_d | DAQP_UPDATE_sense;

struct Solver {
    DAQPWorkspace work{};
    DAQPProblem qp{};
    DAQPResult result{};
    Matrix7 h = Matrix7::Identity();
    Vector7 c = Vector7::Zero(), lower = -Vector7::Ones(), upper = Vector7::Ones(), x, multipliers;
    int sense[JOINTS] = {};

    Solver() {
        qp.n = qp.m = qp.ms = JOINTS;
        qp.H = h.data();
        qp.f = c.data();
        qp.blower = lower.data();
        qp.bupper = upper.data();
        qp.sense = sense;
        result.x = x.data();
        result.lam = multipliers.data();
        if (setup_daqp(&qp, &work, nullptr) < 0) std::exit(2);
    }

    void cold() {
        daqp_deactivate_constraints(&work);
        reset_daqp_workspace(&work);
        daqp_update_ldp(ALL, &work, &qp);
        daqp_solve(&result, &work);
    }

    // Another linear term; the active set of the last solution is where it begins.
    void again() {
        daqp_update_ldp(DAQP_UPDATE_v, &work, &qp);
        daqp_solve(&result, &work);
    }
};

struct Estimator {
    Solver solver;
    Matrix67 j, k;
    Vector7 torque, precision, c0;
    Matrix6 prior_precision, covariance;
    Vector6 prior_variance;
    bool keep_terms = false;
    std::vector<Vector7> linear_terms;
    int programmes = 0;

    Estimator() {
        prior_variance << 100, 100, 100, 0.01, 0.01, 0.01;
        prior_precision = prior_variance.cwiseInverse().asDiagonal();
    }

    Vector6 force() const { return k * (torque - solver.x); }

    void reduce(const Instance& i) {
        j = Eigen::Map<const Matrix67>(&i.jacobian[0][0]);
        torque = Eigen::Map<const Vector7>(i.torque);
        const Vector7 variance = Eigen::Map<const Vector7>(i.variance);
        precision = variance.cwiseInverse();
        Matrix7 s = j.transpose() * prior_variance.asDiagonal() * j;
        s.diagonal() += variance;
        solver.h = 2.0 * s.llt().solve(Matrix7::Identity());
        solver.c.noalias() = c0 = -(solver.h * torque);
        solver.lower = Eigen::Map<const Vector7>(i.lower);
        solver.upper = Eigen::Map<const Vector7>(i.upper);
        const Matrix67 weighted = j * precision.asDiagonal();
        const Matrix6 information = weighted * j.transpose() + prior_precision;
        covariance = information.llt().solve(Matrix6::Identity());
        k.noalias() = covariance * weighted;
    }

    Vector6 estimate(const Instance& i) {
        reduce(i);
        solver.cold();
        programmes = 1;
        return force();
    }

    // The extra term −g'F, g = ± 2λ/σ v, adds (K'g)' t to the programme and ½ P g to the force, P = (J Re^-1 J' + RF^-1)^-1.
    double limit(int axis, double sign) {
        const auto active = [&](int i) { return std::abs(solver.multipliers[i]) > 0.0; };
        unsigned set = 0;
        double shift = 0.0;
        for (int round = 0; round < 50; ++round) {
            Vector7 weight;
            for (int i = 0; i < JOINTS; ++i) weight[i] = (set >> i & 1) ? precision[i] : 0.0;
            const Matrix6 information = j * weight.asDiagonal() * j.transpose() + prior_precision;
            const double sigma = std::sqrt(information.llt().solve(Vector6::Unit(axis))[axis]);
            solver.c.noalias() = c0 + sign * (2.0 * LAMBDA / sigma) * k.row(axis).transpose();
            shift = sign * LAMBDA / sigma * covariance(axis, axis);
            if (keep_terms) linear_terms.push_back(solver.c);
            solver.again();
            ++programmes;
            unsigned grown = set;
            for (int i = 0; i < JOINTS; ++i) grown |= unsigned(active(i)) << i;
            if (grown == set) break;
            set = grown;
        }
        return force()[axis] + shift;
    }
};

int main(int, char** argv) {
    const std::vector<Instance> instances = read_all<Instance>(std::string(argv[1]) + "/instances.txt");
    Estimator e;
    double limits[12];
    const auto all = [&](const Instance& i) {
        keep(e.estimate(i));
        for (int v = 0; v < 12; ++v) limits[v] = e.limit(v / 2, v % 2 ? -1.0 : 1.0);
        keep(limits);
    };
    const auto nothing = [](const Instance&) {};

    if (!std::strcmp(argv[2], "time")) {
        const auto cold = [&](const Instance&) { e.solver.cold(); };
        time_each("qp_cold", instances, [&](const Instance& i) { e.reduce(i); }, cold);
        time_each("qp_warm", instances, [&](const Instance& i) { e.estimate(i); }, [&](const Instance&) { e.solver.again(); });
        // The programmes of an estimate with its limits, their linear terms made beforehand.
        const auto record = [&](const Instance& i) {
            e.keep_terms = true;
            e.linear_terms.clear();
            all(i);
            e.keep_terms = false;
            e.reduce(i);
        };
        time_each("qp_with_limits", instances, record, [&](const Instance&) {
            e.solver.cold();
            for (const Vector7& term : e.linear_terms) {
                e.solver.c = term;
                e.solver.again();
            }
        });
        time_each("estimate", instances, nothing, [&](const Instance& i) { keep(e.estimate(i)); });
        time_each("estimate_with_limits", instances, nothing, all);
        return 0;
    }
    for (size_t k = 0; k < CHECKED; ++k) {
        const Vector6 force = e.estimate(instances[k]);
        print_values("estimate", k, force.data(), 6);
        all(instances[k]);
        print_values("estimate_with_limits", k, limits, 12);
    }
}
