// Stands in for rclcpp where ROS 2 is not installed: as much of it as the node uses. `spin` reads states from standard
// input, one a line, hands them to the subscription, and prints what is published.
#ifndef STAND_IN_RCLCPP_HPP
#define STAND_IN_RCLCPP_HPP

#include <cstdio>
#include <functional>
#include <iostream>
#include <memory>
#include <sstream>
#include <string>
#include <utility>

#include <std_msgs/msg/float64_multi_array.hpp>

namespace rclcpp {

template <class Message>
class Publisher {
public:
    using SharedPtr = std::shared_ptr<Publisher>;
    void publish(const Message &message) {
        for (const double value : message.data) std::printf("%a ", value);
        std::printf("\n");
    }
};

template <class Message>
class Subscription {
public:
    using SharedPtr = std::shared_ptr<Subscription>;
};

class Logger {};

class Node {
public:
    explicit Node(const std::string &) {}
    template <class T>
    T declare_parameter(const std::string &, T value) { return value; }
    template <class Message>
    std::shared_ptr<Publisher<Message>> create_publisher(const std::string &, int) {
        return std::make_shared<Publisher<Message>>();
    }
    template <class Message, class Take>
    std::shared_ptr<Subscription<Message>> create_subscription(const std::string &, int, Take take) {
        take_ = std::move(take);
        return std::make_shared<Subscription<Message>>();
    }
    Logger get_logger() const { return {}; }
    void take(const std_msgs::msg::Float64MultiArray &message) const { take_(message); }

private:
    std::function<void(const std_msgs::msg::Float64MultiArray &)> take_;
};

inline void init(int, char **) {}
inline void shutdown() {}

template <class Any>
void spin(const std::shared_ptr<Any> &node) {
    for (std::string line; std::getline(std::cin, line);) {
        std::istringstream numbers(line);
        std_msgs::msg::Float64MultiArray message;
        for (double value; numbers >> value;) message.data.push_back(value);
        node->take(message);
    }
}

}  // namespace rclcpp

#define RCLCPP_WARN(logger, ...) ((void)(logger), std::fprintf(stderr, __VA_ARGS__), std::fputc('\n', stderr))

#endif
