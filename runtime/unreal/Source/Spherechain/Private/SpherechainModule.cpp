// SPDX-License-Identifier: MIT
#include "HAL/PlatformProcess.h"
#include "Interfaces/IPluginManager.h"
#include "Misc/Paths.h"
#include "Modules/ModuleManager.h"
#include "SpherechainLog.h"

DEFINE_LOG_CATEGORY(LogSpherechain);

// Loads the DLL from the plugin's folder: Windows would not look there.
class FSpherechainModule : public IModuleInterface
{
public:
	virtual void StartupModule() override
	{
#if PLATFORM_WINDOWS
		const FString Folder = IPluginManager::Get().FindPlugin(TEXT("Spherechain"))->GetBaseDir();
		const FString File = FPaths::Combine(Folder, TEXT("Binaries/ThirdParty/spherechain/Win64/spherechain.dll"));
		Library = FPlatformProcess::GetDllHandle(*File);
		if (Library == nullptr) UE_LOG(LogSpherechain, Error, TEXT("%s cannot be loaded"), *File);
#endif
	}

	virtual void ShutdownModule() override
	{
		if (Library != nullptr) FPlatformProcess::FreeDllHandle(Library);
		Library = nullptr;
	}

private:
	void* Library = nullptr;
};

IMPLEMENT_MODULE(FSpherechainModule, Spherechain)
