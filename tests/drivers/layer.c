/* A Vulkan layer for tests: it has a driver say that it has less than it has, and lose its device.
 *
 *   ASPERITY_LAYER_BUFFERS   storage buffers of a shader stage
 *   ASPERITY_LAYER_RANGE     bytes of a storage buffer that a shader sees
 *   ASPERITY_LAYER_THREADS   threads of a workgroup
 *   ASPERITY_LAYER_NO_F64    no double precision in shaders
 *   ASPERITY_LAYER_LOSE      the device is lost after so many submissions
 *
 * run.sh builds it and names it to the loader (VK_INSTANCE_LAYERS). One instance and one device at a
 * time are enough for it. */
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <vulkan/vulkan.h>
#include <vulkan/vk_layer.h>

#define FUNCTIONS_OF_INSTANCE(X) \
    X(vkCreateDevice) \
    X(vkGetPhysicalDeviceProperties) X(vkGetPhysicalDeviceProperties2) \
    X(vkGetPhysicalDeviceFeatures) X(vkGetPhysicalDeviceFeatures2)

#define DECLARE(name) static PFN_##name next_##name;
FUNCTIONS_OF_INSTANCE(DECLARE)
static PFN_vkGetInstanceProcAddr next_instance_proc;
static PFN_vkGetDeviceProcAddr next_device_proc;
static PFN_vkQueueSubmit next_vkQueueSubmit;
static VkInstance instance;
static long submissions;

/* The number that a variable has; none is negative. */
static long wanted(const char *variable) {
    const char *text = getenv(variable);
    return text ? atol(text) : -1;
}

static void lower(const char *variable, uint32_t *limit) {
    long most = wanted(variable);
    if (most >= 0 && (unsigned long)most < *limit) *limit = (uint32_t)most;
}

static void lower_limits(VkPhysicalDeviceLimits *limits) {
    lower("ASPERITY_LAYER_BUFFERS", &limits->maxPerStageDescriptorStorageBuffers);
    lower("ASPERITY_LAYER_RANGE", &limits->maxStorageBufferRange);
    lower("ASPERITY_LAYER_THREADS", &limits->maxComputeWorkGroupInvocations);
}

static void lower_features(VkPhysicalDeviceFeatures *features) {
    if (wanted("ASPERITY_LAYER_NO_F64") > 0) features->shaderFloat64 = VK_FALSE;
}

static VKAPI_ATTR void VKAPI_CALL properties(VkPhysicalDevice device, VkPhysicalDeviceProperties *out) {
    next_vkGetPhysicalDeviceProperties(device, out);
    lower_limits(&out->limits);
}

static VKAPI_ATTR void VKAPI_CALL properties2(VkPhysicalDevice device, VkPhysicalDeviceProperties2 *out) {
    next_vkGetPhysicalDeviceProperties2(device, out);
    lower_limits(&out->properties.limits);
}

static VKAPI_ATTR void VKAPI_CALL features(VkPhysicalDevice device, VkPhysicalDeviceFeatures *out) {
    next_vkGetPhysicalDeviceFeatures(device, out);
    lower_features(out);
}

static VKAPI_ATTR void VKAPI_CALL features2(VkPhysicalDevice device, VkPhysicalDeviceFeatures2 *out) {
    next_vkGetPhysicalDeviceFeatures2(device, out);
    lower_features(&out->features);
}

static VKAPI_ATTR VkResult VKAPI_CALL submit(VkQueue queue, uint32_t count, const VkSubmitInfo *infos, VkFence fence) {
    long most = wanted("ASPERITY_LAYER_LOSE");
    submissions += 1;
    return most >= 0 && submissions > most ? VK_ERROR_DEVICE_LOST : next_vkQueueSubmit(queue, count, infos, fence);
}

/* The link of a chain by which the loader hands the next layer on. */
static const void *link_of(const void *chain, VkStructureType type) {
    const VkBaseInStructure *at = chain;
    while (at && !(at->sType == type && ((const VkLayerInstanceCreateInfo *)at)->function == VK_LAYER_LINK_INFO)) at = at->pNext;
    return at;
}

static VKAPI_ATTR VkResult VKAPI_CALL create_instance(
    const VkInstanceCreateInfo *info, const VkAllocationCallbacks *allocator, VkInstance *out) {
    VkLayerInstanceCreateInfo *link = (void *)link_of(info->pNext, VK_STRUCTURE_TYPE_LOADER_INSTANCE_CREATE_INFO);
    if (!link) return VK_ERROR_INITIALIZATION_FAILED;
    next_instance_proc = link->u.pLayerInfo->pfnNextGetInstanceProcAddr;
    link->u.pLayerInfo = link->u.pLayerInfo->pNext;
    PFN_vkCreateInstance create = (PFN_vkCreateInstance)next_instance_proc(NULL, "vkCreateInstance");
    VkResult result = create ? create(info, allocator, out) : VK_ERROR_INITIALIZATION_FAILED;
    if (result != VK_SUCCESS) return result;
    instance = *out;
#define FIND(name) next_##name = (PFN_##name)next_instance_proc(instance, #name);
    FUNCTIONS_OF_INSTANCE(FIND)
    return VK_SUCCESS;
}

static VKAPI_ATTR VkResult VKAPI_CALL create_device(
    VkPhysicalDevice device, const VkDeviceCreateInfo *info, const VkAllocationCallbacks *allocator, VkDevice *out) {
    VkLayerDeviceCreateInfo *link = (void *)link_of(info->pNext, VK_STRUCTURE_TYPE_LOADER_DEVICE_CREATE_INFO);
    if (!link) return VK_ERROR_INITIALIZATION_FAILED;
    next_device_proc = link->u.pLayerInfo->pfnNextGetDeviceProcAddr;
    PFN_vkCreateDevice create =
        (PFN_vkCreateDevice)link->u.pLayerInfo->pfnNextGetInstanceProcAddr(instance, "vkCreateDevice");
    link->u.pLayerInfo = link->u.pLayerInfo->pNext;
    VkResult result = create ? create(device, info, allocator, out) : VK_ERROR_INITIALIZATION_FAILED;
    if (result != VK_SUCCESS) return result;
    next_vkQueueSubmit = (PFN_vkQueueSubmit)next_device_proc(*out, "vkQueueSubmit");
    return VK_SUCCESS;
}

static VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL device_proc(VkDevice device, const char *name) {
    if (!strcmp(name, "vkGetDeviceProcAddr")) return (PFN_vkVoidFunction)device_proc;
    if (!strcmp(name, "vkQueueSubmit")) return (PFN_vkVoidFunction)submit;
    return next_device_proc(device, name);
}

static VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL instance_proc(VkInstance of, const char *name) {
    static const struct {
        const char *name;
        PFN_vkVoidFunction function;
    } OWN[] = {
        {"vkGetInstanceProcAddr", (PFN_vkVoidFunction)instance_proc},
        {"vkGetDeviceProcAddr", (PFN_vkVoidFunction)device_proc},
        {"vkCreateInstance", (PFN_vkVoidFunction)create_instance},
        {"vkCreateDevice", (PFN_vkVoidFunction)create_device},
        {"vkGetPhysicalDeviceProperties", (PFN_vkVoidFunction)properties},
        {"vkGetPhysicalDeviceProperties2", (PFN_vkVoidFunction)properties2},
        {"vkGetPhysicalDeviceProperties2KHR", (PFN_vkVoidFunction)properties2},
        {"vkGetPhysicalDeviceFeatures", (PFN_vkVoidFunction)features},
        {"vkGetPhysicalDeviceFeatures2", (PFN_vkVoidFunction)features2},
        {"vkGetPhysicalDeviceFeatures2KHR", (PFN_vkVoidFunction)features2},
    };
    for (size_t i = 0; i < sizeof OWN / sizeof *OWN; i++) {
        if (!strcmp(name, OWN[i].name)) return OWN[i].function;
    }
    return next_instance_proc ? next_instance_proc(of, name) : NULL;
}

VKAPI_ATTR VkResult VKAPI_CALL vkNegotiateLoaderLayerInterfaceVersion(VkNegotiateLayerInterface *layer) {
    layer->loaderLayerInterfaceVersion = 2;
    layer->pfnGetInstanceProcAddr = instance_proc;
    layer->pfnGetDeviceProcAddr = device_proc;
    layer->pfnGetPhysicalDeviceProcAddr = NULL;
    return VK_SUCCESS;
}
