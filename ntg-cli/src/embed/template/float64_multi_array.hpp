// Stands in for std_msgs where ROS 2 is not installed.
#ifndef STAND_IN_FLOAT64_MULTI_ARRAY_HPP
#define STAND_IN_FLOAT64_MULTI_ARRAY_HPP

#include <vector>

namespace std_msgs {
namespace msg {

struct Float64MultiArray {
    std::vector<double> data;
};

}  // namespace msg
}  // namespace std_msgs

#endif
