// SPDX-License-Identifier: Apache-2.0
// Prints the driver's statistics of a compiled fragment shader, in lines of "name<tab>number".
//
//   pipeline_statistics VERTEX.spv FRAGMENT.spv ATTRIBUTES [BINDING:KIND ...]
//
// ATTRIBUTES is the number of vertex attributes. KIND is u (uniform block), t (texture), s (sampler) or
// c (texture with sampler). The exit status is 1 if a call of Vulkan fails, 3 without an AMD device.

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <vulkan/vulkan.h>

enum { MOST = 64, AMD = 0x1002 };  // maximum entries of a list; PCI vendor ID of AMD

static void check(VkResult result, const char *call)
{
    if (result == VK_SUCCESS) return;
    fprintf(stderr, "pipeline_statistics: %s: %d\n", call, result);
    exit(1);
}

static VkPhysicalDevice amd_device(void)
{
    VkApplicationInfo application = {
        .sType = VK_STRUCTURE_TYPE_APPLICATION_INFO, .apiVersion = VK_API_VERSION_1_1};
    VkInstanceCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO, .pApplicationInfo = &application};
    VkInstance instance;
    VkPhysicalDevice devices[MOST];
    uint32_t count = MOST;
    check(vkCreateInstance(&info, NULL, &instance), "vkCreateInstance");
    check(vkEnumeratePhysicalDevices(instance, &count, devices), "vkEnumeratePhysicalDevices");
    for (uint32_t i = 0; i < count; ++i) {
        VkPhysicalDeviceProperties properties;
        vkGetPhysicalDeviceProperties(devices[i], &properties);
        if (properties.vendorID == AMD) return devices[i];
    }
    fprintf(stderr, "pipeline_statistics: no AMD device\n");
    exit(3);
}

static VkDevice make_device(VkPhysicalDevice physical)
{
    const char *extension = VK_KHR_PIPELINE_EXECUTABLE_PROPERTIES_EXTENSION_NAME;
    float priority = 1.0f;
    VkPhysicalDevicePipelineExecutablePropertiesFeaturesKHR features = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PIPELINE_EXECUTABLE_PROPERTIES_FEATURES_KHR,
        .pipelineExecutableInfo = VK_TRUE};
    VkDeviceQueueCreateInfo queue = {
        .sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
        .queueCount = 1, .pQueuePriorities = &priority};
    VkDeviceCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO, .pNext = &features,
        .queueCreateInfoCount = 1, .pQueueCreateInfos = &queue,
        .enabledExtensionCount = 1, .ppEnabledExtensionNames = &extension};
    VkDevice device;
    check(vkCreateDevice(physical, &info, NULL, &device), "vkCreateDevice");
    return device;
}

static VkShaderModule read_module(VkDevice device, const char *path)
{
    static uint32_t words[1 << 20];
    FILE *file = fopen(path, "rb");
    if (!file) { perror(path); exit(1); }
    size_t size = fread(words, 1, sizeof words, file);
    fclose(file);
    VkShaderModuleCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO, .codeSize = size, .pCode = words};
    VkShaderModule module;
    check(vkCreateShaderModule(device, &info, NULL, &module), "vkCreateShaderModule");
    return module;
}

static VkPipelineLayout make_layout(VkDevice device, int count, char **texts)
{
    VkDescriptorSetLayoutBinding bindings[MOST];
    for (int i = 0; i < count && i < MOST; ++i) {
        unsigned number = 0;
        char kind = 'u';
        sscanf(texts[i], "%u:%c", &number, &kind);
        bindings[i] = (VkDescriptorSetLayoutBinding){
            .binding = number, .descriptorCount = 1, .stageFlags = VK_SHADER_STAGE_ALL_GRAPHICS,
            .descriptorType = kind == 't'   ? VK_DESCRIPTOR_TYPE_SAMPLED_IMAGE
                              : kind == 's' ? VK_DESCRIPTOR_TYPE_SAMPLER
                              : kind == 'c' ? VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER
                                            : VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER};
    }
    VkDescriptorSetLayoutCreateInfo set_info = {
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
        .bindingCount = count, .pBindings = bindings};
    VkDescriptorSetLayout set;
    check(vkCreateDescriptorSetLayout(device, &set_info, NULL, &set), "vkCreateDescriptorSetLayout");
    VkPipelineLayoutCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO, .setLayoutCount = 1, .pSetLayouts = &set};
    VkPipelineLayout layout;
    check(vkCreatePipelineLayout(device, &info, NULL, &layout), "vkCreatePipelineLayout");
    return layout;
}

static VkRenderPass make_render_pass(VkDevice device)
{
    VkAttachmentDescription attachment = {
        .format = VK_FORMAT_R32G32B32A32_SFLOAT, .samples = VK_SAMPLE_COUNT_1_BIT,
        .finalLayout = VK_IMAGE_LAYOUT_GENERAL};
    VkAttachmentReference color = {.layout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL};
    VkSubpassDescription subpass = {.colorAttachmentCount = 1, .pColorAttachments = &color};
    VkRenderPassCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO, .attachmentCount = 1,
        .pAttachments = &attachment, .subpassCount = 1, .pSubpasses = &subpass};
    VkRenderPass pass;
    check(vkCreateRenderPass(device, &info, NULL, &pass), "vkCreateRenderPass");
    return pass;
}

static VkPipeline compile(VkDevice device, char **files, uint32_t count, VkPipelineLayout layout)
{
    VkPipelineShaderStageCreateInfo stages[2];
    for (int i = 0; i < 2; ++i)
        stages[i] = (VkPipelineShaderStageCreateInfo){
            .sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
            .stage = i ? VK_SHADER_STAGE_FRAGMENT_BIT : VK_SHADER_STAGE_VERTEX_BIT,
            .module = read_module(device, files[i]), .pName = "main"};
    VkVertexInputAttributeDescription attributes[MOST];
    for (uint32_t i = 0; i < count && i < MOST; ++i)
        attributes[i] = (VkVertexInputAttributeDescription){
            .location = i, .format = VK_FORMAT_R32G32B32_SFLOAT, .offset = 12 * i};
    VkVertexInputBindingDescription vertex = {.stride = 12 * count};
    VkPipelineVertexInputStateCreateInfo inputs = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO,
        .vertexBindingDescriptionCount = 1, .pVertexBindingDescriptions = &vertex,
        .vertexAttributeDescriptionCount = count, .pVertexAttributeDescriptions = attributes};
    VkPipelineInputAssemblyStateCreateInfo assembly = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO,
        .topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST};
    VkViewport viewport = {.width = 256, .height = 256, .maxDepth = 1};
    VkRect2D scissor = {.extent = {256, 256}};
    VkPipelineViewportStateCreateInfo view = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO,
        .viewportCount = 1, .pViewports = &viewport, .scissorCount = 1, .pScissors = &scissor};
    VkPipelineRasterizationStateCreateInfo raster = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO, .lineWidth = 1};
    VkPipelineMultisampleStateCreateInfo samples = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO,
        .rasterizationSamples = VK_SAMPLE_COUNT_1_BIT};
    VkPipelineColorBlendAttachmentState channels = {.colorWriteMask = 15};
    VkPipelineColorBlendStateCreateInfo blend = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO,
        .attachmentCount = 1, .pAttachments = &channels};
    VkGraphicsPipelineCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO,
        .flags = VK_PIPELINE_CREATE_CAPTURE_STATISTICS_BIT_KHR, .stageCount = 2, .pStages = stages,
        .pVertexInputState = &inputs, .pInputAssemblyState = &assembly, .pViewportState = &view,
        .pRasterizationState = &raster, .pMultisampleState = &samples, .pColorBlendState = &blend,
        .layout = layout, .renderPass = make_render_pass(device)};
    VkPipeline pipeline;
    check(vkCreateGraphicsPipelines(device, VK_NULL_HANDLE, 1, &info, NULL, &pipeline),
          "vkCreateGraphicsPipelines");
    return pipeline;
}

static void print_statistics(VkDevice device, VkPipeline pipeline)
{
    PFN_vkGetPipelineExecutablePropertiesKHR get_properties =
        (PFN_vkGetPipelineExecutablePropertiesKHR)vkGetDeviceProcAddr(
            device, "vkGetPipelineExecutablePropertiesKHR");
    PFN_vkGetPipelineExecutableStatisticsKHR get_statistics =
        (PFN_vkGetPipelineExecutableStatisticsKHR)vkGetDeviceProcAddr(
            device, "vkGetPipelineExecutableStatisticsKHR");
    VkPipelineExecutablePropertiesKHR properties[MOST];
    VkPipelineExecutableStatisticKHR statistics[MOST];
    for (int i = 0; i < MOST; ++i) {
        properties[i] = (VkPipelineExecutablePropertiesKHR){
            .sType = VK_STRUCTURE_TYPE_PIPELINE_EXECUTABLE_PROPERTIES_KHR};
        statistics[i] = (VkPipelineExecutableStatisticKHR){
            .sType = VK_STRUCTURE_TYPE_PIPELINE_EXECUTABLE_STATISTIC_KHR};
    }
    VkPipelineInfoKHR info = {.sType = VK_STRUCTURE_TYPE_PIPELINE_INFO_KHR, .pipeline = pipeline};
    uint32_t stages = MOST;
    check(get_properties(device, &info, &stages, properties), "vkGetPipelineExecutablePropertiesKHR");
    for (uint32_t stage = 0; stage < stages; ++stage) {
        if (!(properties[stage].stages & VK_SHADER_STAGE_FRAGMENT_BIT)) continue;
        VkPipelineExecutableInfoKHR executable = {
            .sType = VK_STRUCTURE_TYPE_PIPELINE_EXECUTABLE_INFO_KHR,
            .pipeline = pipeline, .executableIndex = stage};
        uint32_t count = MOST;
        check(get_statistics(device, &executable, &count, statistics),
              "vkGetPipelineExecutableStatisticsKHR");
        for (uint32_t i = 0; i < count; ++i)
            printf("%s\t%llu\n", statistics[i].name, (unsigned long long)statistics[i].value.u64);
    }
}

int main(int count, char **words)
{
    if (count < 4) {
        fprintf(stderr, "pipeline_statistics: VERTEX FRAGMENT ATTRIBUTES [BINDING:KIND ...]\n");
        return 1;
    }
    VkDevice device = make_device(amd_device());
    VkPipelineLayout layout = make_layout(device, count - 4, words + 4);
    print_statistics(device, compile(device, words + 1, (uint32_t)atoi(words[3]), layout));
    return 0;  // the end of the process frees all objects
}
