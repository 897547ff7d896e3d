// A node for ROS 2: takes a measured state, plans from it, and publishes the plan's beginning.
//
//   measured (Float64MultiArray)   the state, in the order of `ntg embed --state`; @STATES@ numbers
//   input    (Float64MultiArray)   all functions of time where the plan begins: @NAMES@
//
// Where a plan fails, nothing is published, and the one before stays: a controller holds its last input or brakes.
#include <array>
#include <chrono>
#include <cstddef>
#include <memory>
#include <stdexcept>

#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/float64_multi_array.hpp>

#include "@NAME@.h"

class Planner : public rclcpp::Node {
public:
    Planner() : Node("@NAME@") {
        // Before the loop begins: the one call that allocates and takes its time.
        @NAME@_solver *solver = nullptr;
        if (@NAME@_create(&parameters_, &solver) > @UPPER@_ACCEPTABLE) {
            throw std::runtime_error(@NAME@_message(nullptr));
        }
        solver_.reset(solver);
        max_seconds_ = declare_parameter<double>("max_seconds", 0.02);
        publisher_ = create_publisher<std_msgs::msg::Float64MultiArray>("input", 1);
        input_.data.resize(readings_.size());
        subscription_ = create_subscription<std_msgs::msg::Float64MultiArray>(
            "measured", 1, [this](const std_msgs::msg::Float64MultiArray &measured) { plan(measured); });
    }

private:
    void plan(const std_msgs::msg::Float64MultiArray &measured) {
        if (measured.data.size() != @STATES@) {
            RCLCPP_WARN(get_logger(), "a state of %zu numbers, not @STATES@", measured.data.size());
            return;
        }
@RECEIVE@
        int status = @NAME@_set(solver_.get(), &parameters_);
        if (status == @UPPER@_OK) status = @NAME@_solve(solver_.get(), 100, max_seconds_);
        @NAME@_numbers numbers{};
        if (status > @UPPER@_ACCEPTABLE || @NAME@_info(solver_.get(), &numbers) != @UPPER@_OK) {
            RCLCPP_WARN(get_logger(), "%s", @NAME@_message(solver_.get()));
            return;
        }
        for (std::size_t i = 0; i < readings_.size(); ++i) {
            @NAME@_read(solver_.get(), readings_[i], 0, numbers.start, &input_.data[i]);
        }
        publisher_->publish(input_);
    }

    struct Destroy {
        void operator()(@NAME@_solver *solver) const noexcept { @NAME@_destroy(solver); }
    };

    @NAME@_parameters parameters_ = @UPPER@_DEFAULTS;
    const std::array<int, @FUNCTIONS@> readings_{{@SHOWN@}};
    std::unique_ptr<@NAME@_solver, Destroy> solver_;
    double max_seconds_ = 0.02;
    std_msgs::msg::Float64MultiArray input_;
    rclcpp::Publisher<std_msgs::msg::Float64MultiArray>::SharedPtr publisher_;
    rclcpp::Subscription<std_msgs::msg::Float64MultiArray>::SharedPtr subscription_;
};

int main(int words, char **word) {
    rclcpp::init(words, word);
    rclcpp::spin(std::make_shared<Planner>());
    rclcpp::shutdown();
    return 0;
}
