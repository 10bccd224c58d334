// SPDX-License-Identifier: MIT
using System.IO;
using UnrealBuildTool;

public class Spherechain : ModuleRules
{
	public Spherechain(ReadOnlyTargetRules Target) : base(Target)
	{
		PCHUsage = PCHUsageMode.UseExplicitOrSharedPCHs;
		PublicDependencyModuleNames.AddRange(new string[] { "Core", "CoreUObject", "Engine" });
		PrivateDependencyModuleNames.Add("Projects");

		string Library = Path.Combine(PluginDirectory, "Source", "ThirdParty", "spherechain");
		PublicSystemIncludePaths.Add(Path.Combine(Library, "include"));
		if (Target.Platform == UnrealTargetPlatform.Win64)
		{
			// The DLL lies in the plugin, not beside the program: the module loads it before the first call.
			PublicDefinitions.Add("SPHERECHAIN_SHARED=1");
			PublicAdditionalLibraries.Add(Path.Combine(Library, "lib", "Win64", "spherechain.lib"));
			PublicDelayLoadDLLs.Add("spherechain.dll");
			RuntimeDependencies.Add(Path.Combine(PluginDirectory, "Binaries", "ThirdParty", "spherechain", "Win64", "spherechain.dll"));
		}
		else if (Target.Platform == UnrealTargetPlatform.Linux)
		{
			PublicAdditionalLibraries.Add(Path.Combine(Library, "lib", "Linux", "libspherechain.a"));
		}
	}
}
