#pragma once

#include <opencv2/core.hpp>

namespace soffit {

/// Median of the `size_px` x `size_px` window around every pixel, for each channel on its own; pixels outside
/// the picture are those of the nearest edge. Equal, bit by bit, to cv::medianBlur of the picture alone (what
/// lies around a region of interest is not read), and for 8-bit pictures with 1 or 3 channels and 7 px many
/// times as fast.
///
/// Those take branch-free sorting networks, a vector register of neighbouring bytes at a time, with work
/// shared between overlapping windows: A. Adams, "Fast median filters using separable sorting networks", ACM
/// Transactions on Graphics 40(4), 2021. The networks are odd-even merges: K. E. Batcher, "Sorting networks
/// and their applications", AFIPS 1968. The best instructions of the processor are chosen at run time.
/// Everything else is left to OpenCV.
///
/// Throws cv::Exception when there are no pixels, or `size_px` is even or not positive. Pure; O(pixels).
cv::Mat FilterMedian(const cv::Mat& picture, int size_px);

/// Rows `rows` of that alone, into `filtered`, whose memory is used again when it fits. ContractViolation
/// when they do not lie within the picture.
void FilterMedian(const cv::Mat& picture, const cv::Range& rows, int size_px, cv::Mat& filtered);

}  // namespace soffit
