// Times of Pinocchio's algorithms (see problem.hpp). The model is built from numbers, with its fixed-axis joint type.
#include <pinocchio/algorithm/aba.hpp>
#include <pinocchio/algorithm/crba.hpp>
#include <pinocchio/algorithm/frames.hpp>
#include <pinocchio/algorithm/jacobian.hpp>
#include <pinocchio/algorithm/kinematics.hpp>
#include <pinocchio/algorithm/regressor.hpp>
#include <pinocchio/algorithm/rnea.hpp>
#include <pinocchio/multibody.hpp>

#include "problem.hpp"

namespace pin = pinocchio;
using Matrix3 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
using Vector = Eigen::VectorXd;

struct Inputs {
    Vector q, qd, qdd, tau;
};

static pin::Model model_of(const Arm& arm, pin::FrameIndex& flange) {
    pin::Model model;
    pin::JointIndex parent = 0;
    const auto place = [](const double* r, const double* p) {
        return pin::SE3(Eigen::Map<const Matrix3>(r), Eigen::Map<const Eigen::Vector3d>(p));
    };
    for (int k = 0; k < JOINTS; ++k) {
        const Link& link = arm.links[k];
        parent = model.addJoint(parent, pin::JointModelRZ(), place(link.rotation, link.translation), "joint" + std::to_string(k));
        const pin::Inertia inertia(link.mass, Eigen::Map<const Eigen::Vector3d>(link.com), Matrix3(Eigen::Map<const Matrix3>(link.inertia)));
        model.appendBodyToJoint(parent, inertia, pin::SE3::Identity());
    }
    flange = model.addFrame(pin::Frame("flange", parent, 0, place(arm.flange_rotation, arm.flange_translation), pin::OP_FRAME));
    model.gravity.linear() = Eigen::Map<const Eigen::Vector3d>(arm.gravity);
    return model;
}

int main(int, char** argv) {
    const Arm arm = read_arm(argv[1]);
    pin::FrameIndex flange;
    const pin::Model model = model_of(arm, flange);
    pin::Data data(model);
    const Vector zero = Vector::Zero(JOINTS);
    pin::Data::Matrix6x jacobian = pin::Data::Matrix6x::Zero(6, JOINTS);
    pin::Motion drift;
    std::vector<Inputs> states;
    for (const State& s : read_states(argv[1])) {
        const auto vector = [](const double* x) { return Vector(Eigen::Map<const Vector>(x, JOINTS)); };
        states.push_back({vector(s.q), vector(s.qd), vector(s.qdd), vector(s.tau)});
    }

    const auto rnea = [&](const Inputs& s) { keep(pin::rnea(model, data, s.q, s.qd, s.qdd)); };
    const auto crba = [&](const Inputs& s) { keep(pin::crba(model, data, s.q, pin::Convention::LOCAL)); };
    const auto crba_world = [&](const Inputs& s) { keep(pin::crba(model, data, s.q, pin::Convention::WORLD)); };
    const auto aba = [&](const Inputs& s) { keep(pin::aba(model, data, s.q, s.qd, s.tau, pin::Convention::LOCAL)); };
    const auto aba_world = [&](const Inputs& s) { keep(pin::aba(model, data, s.q, s.qd, s.tau, pin::Convention::WORLD)); };
    const auto bias = [&](const Inputs& s) { keep(pin::nonLinearEffects(model, data, s.q, s.qd)); };
    const auto gravity = [&](const Inputs& s) { keep(pin::computeGeneralizedGravity(model, data, s.q)); };
    const auto frame_jacobian = [&](const Inputs& s) {
        pin::computeFrameJacobian(model, data, s.q, flange, pin::LOCAL_WORLD_ALIGNED, jacobian);
        keep(jacobian);
    };
    // Pose, Jacobian and J̇q̇: the classical acceleration of the flange without joint acceleration.
    const auto frame_terms = [&](const Inputs& s) {
        pin::forwardKinematics(model, data, s.q, s.qd, zero);
        pin::computeJointJacobians(model, data);
        pin::updateFramePlacement(model, data, flange);
        pin::getFrameJacobian(model, data, flange, pin::LOCAL_WORLD_ALIGNED, jacobian);
        drift = pin::getFrameClassicalAcceleration(model, data, flange, pin::LOCAL_WORLD_ALIGNED);
        keep(jacobian);
        keep(drift);
    };
    const auto control_terms = [&](const Inputs& s) {
        frame_terms(s);
        crba(s);
        data.M.triangularView<Eigen::StrictlyLower>() = data.M.transpose().triangularView<Eigen::StrictlyLower>();
        bias(s);
    };
    const auto regressor = [&](const Inputs& s) { keep(pin::computeJointTorqueRegressor(model, data, s.q, s.qd, s.qdd)); };

    if (!std::strcmp(argv[2], "time")) {
        time_calls("rnea", states, rnea);
        time_calls("crba", states, crba);
        time_calls("crba_world", states, crba_world);
        time_calls("aba", states, aba);
        time_calls("aba_world", states, aba_world);
        time_calls("bias", states, bias);
        time_calls("gravity", states, gravity);
        time_calls("jacobian", states, frame_jacobian);
        time_calls("jacobian_drift", states, frame_terms);
        time_calls("control_terms", states, control_terms);
        time_calls("regressor", states, regressor);
        return 0;
    }
    Vector parameters(10 * JOINTS);
    for (int k = 0; k < JOINTS; ++k) parameters.segment<10>(10 * k) = model.inertias[size_t(k) + 1].toDynamicParameters();
    for (size_t k = 0; k < CHECKED; ++k) {
        const Inputs& s = states[k];
        rnea(s);
        print_values("rnea", k, data.tau.data(), JOINTS);
        for (const char* name : {"crba", "crba_world"}) {
            data.M.setZero();
            std::strcmp(name, "crba") ? crba_world(s) : crba(s);
            data.M.triangularView<Eigen::StrictlyLower>() = data.M.transpose().triangularView<Eigen::StrictlyLower>();
            print_values(name, k, data.M.data(), JOINTS * JOINTS);
        }
        aba(s);
        print_values("aba", k, data.ddq.data(), JOINTS);
        aba_world(s);
        print_values("aba_world", k, data.ddq.data(), JOINTS);
        bias(s);
        print_values("bias", k, data.nle.data(), JOINTS);
        gravity(s);
        print_values("gravity", k, data.g.data(), JOINTS);
        const auto angular_first = [](const auto& rows) {
            Eigen::MatrixXd turned(6, rows.cols());
            turned << rows.bottomRows(3), rows.topRows(3);
            return turned;
        };
        frame_jacobian(s);
        print_values("jacobian", k, angular_first(jacobian).data(), 6 * JOINTS);
        control_terms(s);
        print_values("jacobian_drift", k, angular_first(drift.toVector()).data(), 6);
        Vector all(49 + 7);
        all << Eigen::Map<const Vector>(data.M.data(), 49), data.nle;
        print_values("control_terms", k, all.data(), 56);
        regressor(s);
        const Vector torque = data.jointTorqueRegressor * parameters;
        print_values("regressor", k, torque.data(), JOINTS);
    }
}
